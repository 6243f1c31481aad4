// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/registry.h"
#include "keepout/step/solver.h"

namespace keepout {

/// One way to solve the step problem, by name.
struct SolverBackend {
  std::string_view name;         // to ask for it by
  std::string_view description;  // one line, for lists
  /// A new one; as make_solver.
  std::unique_ptr<Solver> (*make)();
  Allocation allocation;  // whether it takes memory while it solves
  /// How far an `optimal` answer may be from the best one, and from satisfying the KKT conditions:
  /// relative, as KktResidual is.
  double accuracy;
  std::string (*library)();  // name and version of the library behind it; null for our own
};

/// Returns all solvers, our own first. Loads the module of NLopt's (see keepout/module.h).
Registry<SolverBackend> solver_backends();

/// Returns the names of the solvers that can be had. Loads no module.
std::vector<std::string> solver_names();

/// Returns a new solver, without room yet: see Solver::reserve. Loads at most the module that
/// brings it. Throws Error for an unknown name.
std::unique_ptr<Solver> make_solver(std::string_view name);

}  // namespace keepout

/// The table of a module that brings solvers.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::SolverBackend>
    keepout_solvers;
