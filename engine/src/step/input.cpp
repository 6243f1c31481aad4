// SPDX-License-Identifier: BSD-3-Clause
#include "input.h"

#include <string>

#include "keepout/error.h"
#include "keepout/step/solver.h"

namespace keepout {
namespace {

// A limit for numbers that are not lengths: their products with lengths must stay finite.
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
  const double clearance = required_clearance(options);
  if (clearance > longest_length) {
    throw Error("margin: expected at most 1e15 together with tool_radius, got " +
                text_of(options.margin) + " beside " + text_of(options.tool_radius));
  }
  if (position_rounding(Vec3::Zero(), options) > 1e-3 * options.radius) {
    throw Error("radius: expected more than 1e-9 of tool_radius plus margin, which is " +
                text_of(clearance) + " (rounding hides a smaller radius), got " +
                text_of(options.radius));
  }
}

std::optional<Status> refusal(const Motion& request, const StepOptions& options) noexcept {
  if (!are_within(longest_length, request.tip) || !are_within(longest_length, request.desired)) {
    return Status::invalid_input;
  }
  if (const auto& j = request.jacobian) {
    if (j->joints() < 1 || j->data() == nullptr || !are_within(largest_number, j->matrix())) {
      return Status::invalid_input;
    }
  }
  const Eigen::Index variables = request.jacobian ? request.jacobian->joints() : 3;
  if (request.rows && !are_usable(*request.rows, variables)) return Status::invalid_input;
  // Too far from the origin, a step is lost in the rounding of the tip.
  if (position_rounding(request.tip, options) > 1e-3 * options.radius) return Status::invalid_input;
  if (!(request.desired.norm() <= longest_motion(options))) return Status::beyond_reach;
  return std::nullopt;
}

EndRegion end_region_of(const Motion& request, EndRegion rule_region) noexcept {
  // With joints or rows of the caller's own, the motion need not be a projection of the target.
  return request.jacobian || request.rows ? EndRegion::motion_sphere : rule_region;
}

RuleInput rule_input_of(const Motion& request, const StepOptions& options,
                        EndRegion rule_region) noexcept {
  const EndRegion ends = end_region_of(request, rule_region);
  return {.tip = request.tip,
          .target = request.desired,
          .accepted = Vec3::Zero(),
          .radius = options.radius,
          .longest = longest_motion(options),
          .clearance = required_clearance(options),
          .recovery = options.recovery,
          .rounding = position_rounding(request.tip, options),
          .searched_region = options.query == Query::motion ? ends : EndRegion::motion_sphere};
}

}  // namespace keepout
