// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/registry.h"
#include "keepout/step/solver.h"

namespace keepout {

/// A solver of the step problem (StepProblem) that make_solver() makes by its name.
struct SolverBackend {
  std::string_view name;         // for make_solver
  std::string_view description;  // one line, for lists
  /// Makes a new solver, like make_solver.
  std::unique_ptr<Solver> (*make)();
  Allocation allocation;  // use of heap memory while it solves
  /// Bound of two relative errors of an `optimal` solution: its distance from the best solution,
  /// and its KktResidual.
  double accuracy;
  std::string (*library)();  // name and version of the underlying library; null for keepout's own
};

/// Returns all solvers, keepout's own first. Loads the module of the NLopt solvers (see
/// keepout/module.h).
Registry<SolverBackend> solver_backends();

/// Adds the solvers of a plugin: a shared object that exports the table `keepout_solvers` (see
/// docs/adding_a_backend.md). Returns their number, 0 without such a table. For the arguments,
/// errors and the precondition see PartTable::add in keepout/module.h. All other functions then
/// know them.
std::size_t add_solver_backends(const std::string& plugin);

/// Returns the names of the available solvers. Loads no module.
std::vector<std::string> solver_names();

/// Returns a new solver without reserved memory: see Solver::reserve. Loads no module except that
/// of the solver. Throws Error for an unknown name.
std::unique_ptr<Solver> make_solver(std::string_view name);

}  // namespace keepout

/// The table of the solvers of a module.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::SolverBackend>
    keepout_solvers;
