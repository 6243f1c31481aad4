// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

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

/// All solvers of this build, our own first.
Registry<SolverBackend> solver_backends() noexcept;

/// A new solver, without room yet: see Solver::reserve. Throws Error for a name that is not in the
/// table, listing those that are.
std::unique_ptr<Solver> make_solver(std::string_view name);

}  // namespace keepout
