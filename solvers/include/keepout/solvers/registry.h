// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "keepout/step/solver.h"

namespace keepout {

/// One way to solve the step problem, by name.
struct SolverBackend {
  std::string_view name;
  std::string_view description;
  std::unique_ptr<Solver> (*make)();
};

/// All solvers of this build, our own first.
std::span<const SolverBackend> solver_backends() noexcept;

/// A new solver, without room yet: see Solver::reserve. Throws Error for a name that is not in the
/// table, listing those that are.
std::unique_ptr<Solver> make_solver(std::string_view name);

}  // namespace keepout
