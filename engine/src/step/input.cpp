// SPDX-License-Identifier: BSD-3-Clause
#include "input.h"

#include "keepout/step/solver.h"

namespace keepout {
namespace {

// Squares and cubes of lengths must stay finite; the mesh keeps to the same limit.
constexpr double largest_number = 1e30;

// So that the work of a step stays bounded.
constexpr int most_refinements = 1000;
constexpr int most_nodes = 1 << 16;

template <class Numbers>
bool are_usable(const Numbers& numbers) noexcept {
  return (numbers.array().abs() <= largest_number).all();  // false for NaN
}

bool is_usable(double length) noexcept { return length >= 0.0 && length <= largest_number; }

bool are_usable(const ExtraRows& rows, Eigen::Index variables) noexcept {
  if (rows.count() < 0) return false;
  if (rows.count() == 0) return true;
  if (rows.matrix() == nullptr || rows.bounds() == nullptr) return false;
  using Numbers = Eigen::Map<const StepProblem::Vector>;
  return are_usable(Numbers(rows.matrix(), rows.count() * variables)) &&
         are_usable(Numbers(rows.bounds(), rows.count()));
}

}  // namespace

Status check(const Motion& motion, const StepOptions& options) noexcept {
  const bool usable =
      are_usable(motion.tip) && are_usable(motion.desired) && options.radius > 0.0 &&
      is_usable(options.radius) && is_usable(options.tool_radius) && is_usable(options.margin) &&
      is_usable(distance_kept(options)) && is_usable(options.damping) &&
      is_usable(options.recovery) && is_usable(options.deepest) && options.refinements >= 0 &&
      options.refinements <= most_refinements && options.nodes >= 0 && options.nodes <= most_nodes;
  if (!usable) return Status::invalid_input;
  if (const auto& j = motion.jacobian) {
    if (j->joints() < 1 || j->data() == nullptr || !are_usable(j->matrix())) {
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

Surroundings surroundings_of(const Motion& motion, const StepOptions& options,
                             Reach projections) noexcept {
  // With joints or rows of the caller's own the answer need not be a projection of the aim.
  const Reach reached = motion.jacobian || motion.rows ? Reach::sphere : projections;
  return {.tip = motion.tip,
          .aim = motion.desired,
          .kept = Vec3::Zero(),
          .radius = options.radius,
          .longest = longest_motion(options),
          .margin = distance_kept(options),
          .recovery = options.recovery,
          .rounding = position_rounding(motion.tip, options),
          .reach = reached,
          .searched = options.query == Query::motion ? reached : Reach::sphere,
          .is_projected = false};
}

}  // namespace keepout
