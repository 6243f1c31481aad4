// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/motion_constraint.h"
#include "keepout/step/solver.h"

namespace keepout {

/// Whether a tip may be there: standing still is a certified step, and no recovery. So the point
/// keeps the margin to within 2.75 tau (docs/certified-step.md) and, where the guard asks about
/// sides, is on the free one. A point that is no number may not.
bool keeps_margin(MotionConstraint& guard, const Vec3& point) noexcept;

/// The part of a straight way that is proven, from its start on.
struct ProvenPrefix {
  /// The fraction of the segment that is proved; 1: all of it, with its end.
  double fraction = 0.0;
  Vec3 end;  // from + fraction (to - from); `from` itself when nothing is proven [length]
  bool may_start = false;  // `from` may be stood on

  /// Whether all of the way is proven, both ends included.
  bool whole() const noexcept { return may_start && fraction == 1.0; }
};

/// Whether the certified rule proves the whole straight way: from its start to its end, both
/// included, it keeps the margin - 3 tau from the mesh. A way longer than the motion sphere is
/// proven in pieces. What the rule would not prove within its budget is not proven.
///
/// Precondition: the rule proves what it lets pass, as `certified` does; the solver's answer is
/// exact where no plane holds it, as the active set's is: from others more may be left unproven.
bool proves(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept;

/// The same, and how far it is proven if not to the end: to within 2^-8 of a piece.
ProvenPrefix proven_prefix(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept;

/// A solver for a guard that only validates: it gives up on every problem. A motion that nothing
/// holds back needs no solver; one that something does is refused at the first contact, without a
/// search for the best motion in its place. With the certified rule, what is proven is the same;
/// such a guard is of no use to steer.
class StraightOnly final : public Solver {
 public:
  void reserve(int, int) override {}
  bool reads_planes() const noexcept override { return true; }
  bool ignores_idle_planes() const noexcept override { return true; }
  SolveStatus solve(const StepProblem&, Solution&) noexcept override {
    return SolveStatus::iteration_limit;
  }
};

}  // namespace keepout
