// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/motion_constraint.h"
#include "keepout/step/solver.h"

namespace keepout {

/// Returns true if a tip may be at the point. Zero motion is then a certified step that is not a
/// recovery. The point is at most 2.75 tau closer than the required clearance; tau is the tolerance
/// of docs/certified-step.md. If the guard classifies tips, the point is also on the free side.
/// Returns false for a point that is not finite.
bool keeps_margin(MotionConstraint& guard, const Vec3& point) noexcept;

/// The part of a straight motion that is proved, from its start on.
struct ProvenPrefix {
  /// The fraction of the segment that is proved; 1: all of it, with its end.
  double fraction = 0.0;
  Vec3 end;                // from + fraction (to - from); `from` if no part is proved [length]
  bool may_start = false;  // true if the tip may be at `from`

  /// Returns true if the whole motion is proved, including both ends.
  bool whole() const noexcept { return may_start && fraction == 1.0; }
};

/// Returns true if the certified rule proves the whole straight motion, including both ends. The
/// motion then maintains the required clearance - 3 tau. A motion longer than the radius of the
/// motion sphere is proved in pieces. Returns false if the work budget ends first.
///
/// Precondition: the rule proves each motion that it accepts, like `certified`. If no plane limits
/// a motion, the solver should return the motion exactly, like the active-set solver. With other
/// solvers, fewer motions are proved.
bool proves(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept;

/// Returns the part of a straight motion that is proved, with a resolution of 2^-8 of a piece.
/// Otherwise like proves.
ProvenPrefix proven_prefix(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept;

/// A solver that fails on every problem, for a guard that only validates motions. A free motion
/// needs no solver. Any other motion is rejected at the first contact, without a search for a
/// better motion. The certified rule proves the same motions as with another solver.
/// ProjectingSteer cannot use such a guard.
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
