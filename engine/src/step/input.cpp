// SPDX-License-Identifier: BSD-3-Clause
#include "input.h"

#include "keepout/error.h"
#include "keepout/step/solver.h"

namespace keepout {
namespace {

// Of what is no length: products of it and of lengths must stay finite.
constexpr double largest_number = 1e30;

template <class Numbers>
bool are_within(double largest, const Numbers& numbers) noexcept {
  return (numbers.array().abs() <= largest).all();  // false for NaN
}

bool are_usable(const ExtraRows& rows, Eigen::Index variables) noexcept {
  if (rows.count() < 0) return false;
  if (rows.count() == 0) return true;
  if (rows.matrix() == nullptr || rows.bounds() == nullptr) return false;
  using Numbers = Eigen::Map<const StepProblem::Vector>;
  return are_within(largest_number, Numbers(rows.matrix(), rows.count() * variables)) &&
         are_within(largest_number, Numbers(rows.bounds(), rows.count()));
}

}  // namespace

void require_in_range(const StepOptions& options) {
  require_in_range(step_options, options);
  if (required_clearance(options) > longest_length ||
      position_rounding(Vec3::Zero(), options) > 1e-3 * options.radius) {
    throw Error(
        "tool_radius and margin together must be at most 1e15, and not so large that the radius is "
        "lost in their rounding");
  }
}

Status check(const Motion& motion, const StepOptions& options) noexcept {
  if (!are_within(longest_length, motion.tip) || !are_within(longest_length, motion.desired)) {
    return Status::invalid_input;
  }
  if (const auto& j = motion.jacobian) {
    if (j->joints() < 1 || j->data() == nullptr || !are_within(largest_number, j->matrix())) {
      return Status::invalid_input;
    }
  }
  const Eigen::Index variables = motion.jacobian ? motion.jacobian->joints() : 3;
  if (motion.rows && !are_usable(*motion.rows, variables)) return Status::invalid_input;
  // So far from the origin that a step is lost in the digits of the tip.
  if (position_rounding(motion.tip, options) > 1e-3 * options.radius) return Status::invalid_input;
  if (!(motion.desired.norm() <= longest_motion(options))) return Status::beyond_reach;
  return Status::free;
}

CycleProblem cycle_problem_of(const Motion& motion, const StepOptions& options,
                              EndRegion projections) noexcept {
  // With joints or rows of the caller's own the motion need not be a projection of the target.
  const EndRegion ends = motion.jacobian || motion.rows ? EndRegion::motion_sphere : projections;
  return {.tip = motion.tip,
          .target = motion.desired,
          .accepted = Vec3::Zero(),
          .radius = options.radius,
          .longest = longest_motion(options),
          .margin = required_clearance(options),
          .recovery = options.recovery,
          .rounding = position_rounding(motion.tip, options),
          .end_region = ends,
          .searched_region = options.query == Query::motion ? ends : EndRegion::motion_sphere,
          .is_projected = false};
}

}  // namespace keepout
