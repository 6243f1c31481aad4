// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/solver.h"

namespace keepout {

/// A solver for a guard that only validates: it gives up on every problem. A motion that nothing
/// holds back needs no solver; one that something does is refused at the first contact, without a
/// search for the best motion in its place. With the certified rule, what is proven is the same;
/// such a guard is of no use to steer.
class StraightOnly final : public Solver {
 public:
  void reserve(int, int) override {}
  bool reads_planes() const noexcept override { return true; }
  SolveStatus solve(const StepProblem&, Solution&) noexcept override {
    return SolveStatus::iteration_limit;
  }
};

}  // namespace keepout
