// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/problem.h"
#include "keepout/step/solver.h"

/// What every solver refuses in the same way, before it looks at the rows one by one.
namespace keepout {

bool shapes_agree(const StepProblem& problem) noexcept;

/// J, d and damping are numbers, and not too large to calculate with.
bool cost_in_range(const StepProblem& problem) noexcept;

/// `optimal`, or what is wrong with the rows: a number out of range, or a row that no u satisfies.
/// Precondition: they are written.
SolveStatus check_rows(const StepProblem& problem) noexcept;

}  // namespace keepout
