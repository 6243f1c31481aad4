// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "branches.h"
#include "keepout/activation/activation_rule.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "tip_guides.h"

namespace keepout {

/// Returns a vector with +0 in place of -0, so that the sign of a zero in the input does not show.
inline Vec3 without_signed_zeros(const Vec3& v) noexcept {
  return {v[0] + 0.0, v[1] + 0.0, v[2] + 0.0};
}

/// The memory of the cycles of a tip: planes and guides, their quadratic program, and the best
/// result so far. `planes` belong to the present search; after a search with a result, to that
/// result.
class TipMemory {
 public:
  /// Allocates all memory. Planes are written as rows only if the solver does not read planes.
  TipMemory(const Capacity& capacity, const Solver& solver);

  /// Returns true if the request's joints and rows fit the capacity.
  bool has_room_for(const Motion& request) const noexcept;

  /// Returns the quadratic program. Its rows are the planes, those of guides, then the caller's
  /// rows. They limit the tip's own increment, or the joints' (n^T J) with a Jacobian. Reads only
  /// Jacobian and rows of the request. `target`: the increment that the tip tries to reach.
  /// [length] Valid until the next call. Precondition: has_room_for(request).
  StepProblem program_for(const Motion& request, const Vec3& target, double damping) noexcept;

  /// Stores a motion as the result, which outlives the solver's next solution. With joints, stores
  /// `fraction` of `solution`; otherwise `tip_motion` as it is. The active rows are those of the
  /// solution. `relaxation`: the constraints that were relaxed. `limits`: the limits apart from
  /// active rows.
  void store_result(const Motion& request, const Vec3& tip_motion, double fraction,
                    const Solution& solution, Relaxation relaxation, Limits limits) noexcept;

  /// Stores zero motion as the result, without active rows.
  void store_zero_result(const Motion& request, Relaxation relaxation, Limits limits) noexcept;

  /// Returns the planes and those of guides, as the solver gets them. Valid until the next call of
  /// this or result_planes().
  std::span<const HalfSpace> solver_planes() noexcept {
    return with_guides(guides.planes().size());
  }

  TipGuides guides;                // of the tip
  HalfSpaceBuffer planes;          // of the present trial
  HalfSpaceBuffer earlier_planes;  // of the motion that a search tries to improve
  HalfSpaceBuffer alternatives;    // to a plane of the branch and bound
  Branches branches;               // of the branch and bound

  /// Sets planes and result aside as the earlier ones, for a search that may find better ones.
  /// Until the next store_result() the present result is undefined.
  void set_aside() noexcept {
    swap_with_earlier();
    planes.clear();
  }

  /// Restores the planes and the result that were set aside last, after a search without success.
  void take_back() noexcept { swap_with_earlier(); }

  /// Returns the increment of the result.
  std::span<const double> increment() const noexcept { return result_.increment.view(); }
  /// Returns the rows that limit the increment: planes, those of guides, then the caller's.
  std::span<const std::uint32_t> active() const noexcept { return result_.active.view(); }
  /// Returns the planes and those of guides that the result was found with. Precondition: `planes`
  /// are those of the result.
  std::span<const HalfSpace> result_planes() noexcept { return with_guides(result_.guide_planes); }
  /// Returns the constraints that were relaxed for the result.
  Relaxation relaxation() const noexcept { return result_.relaxation; }
  /// Returns the limits of the result apart from active rows.
  Limits limits() const noexcept { return result_.limits; }

 private:
  struct Result {
    Buffer<double> increment;      // (variables)
    Buffer<std::uint32_t> active;  // (planes + those of guides + extra rows)
    std::size_t guide_planes = 0;  // the number of half-spaces of guides
    Relaxation relaxation = Relaxation::none;
    Limits limits = {};
  };

  std::span<const HalfSpace> with_guides(std::size_t guide_planes) noexcept {
    return guide_planes == 0 ? planes.view() : join_guides(guide_planes);
  }
  std::span<const HalfSpace> join_guides(std::size_t guide_planes) noexcept;
  void swap_with_earlier() noexcept;
  void write_rows_of(std::span<const HalfSpace> half_spaces, const double* jacobian,
                     Eigen::Index variables) noexcept;

  Eigen::Index variables_;   // the most columns of a Jacobian, at least 3
  Eigen::Index extra_rows_;  // the most rows of the caller's own
  bool writes_planes_;
  std::vector<double>
      jacobian_;                // (3, variables), column by column: a packed copy of another layout
  std::vector<double> rows_;    // (planes + those of guides + extra rows, variables), row by row
  std::vector<double> bounds_;  // (planes + those of guides + extra rows)
  HalfSpaceBuffer joined_planes_;  // planes and those of guides
  Vec3 target_ = Vec3::Zero();
  Result result_;
  Result earlier_result_;
};

}  // namespace keepout
