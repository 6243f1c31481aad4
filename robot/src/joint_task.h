// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/robot/instrument_options.h"
#include "point_motion.h"

namespace keepout {

/// The task of the joints: minimize |J u - v|^2 + damping |u|^2. Here u is dq with each joint in a
/// unit of its own, so that a radian and a length count about the same: dq_k = unit_k u_k.
struct JointTask {
  static constexpr int most_equations = Chain::most_joints;
  static_assert(most_equations >= 6, "a task of the flange has 6");

  std::array<double, most_equations * Chain::most_joints>
      jacobian{};                                // J (equations, n), column by column
  std::array<double, most_equations> desired{};  // v (equations)
  int equations = 0;
  int joints = 0;
  double damping = 0.0;
  JointVector unit{};         // [rad or length]
  double miss_at_rest = 0.0;  // |v|: the miss of zero motion, in the unit of v
  /// InstrumentOptions::orientation_weight; empty if the task is not one of the flange.
  /// [length/rad]
  std::optional<double> orientation_weight = std::nullopt;

  /// Returns true if it is a task of the flange, and not of the joints.
  bool is_of_flange() const noexcept { return orientation_weight.has_value(); }
  /// Returns the cost of an increment dq, the minimized sum. [length^2; for a task of the joints
  /// the square of their unit]
  double cost(const JointVector& increment) const noexcept;
  /// Returns the cost of a fraction of an increment.
  double cost_of_share(const JointVector& increment, double fraction) const noexcept;
  /// Returns the fraction of an increment, at most `most`, that costs least: 0 if every fraction
  /// costs more than zero motion.
  double best_share(const JointVector& increment, double most) const noexcept;
  /// Returns a joint's increment in its unit.
  double in_units(const JointVector& increment, int k) const noexcept {
    return increment[static_cast<std::size_t>(k)] / unit[static_cast<std::size_t>(k)];
  }
  /// Returns the task for a fraction of the desired motion.
  JointTask scaled(double fraction) const noexcept;
  /// Returns the task with 16 times the damping, or with some damping if it has none.
  JointTask damped() const noexcept;
  /// Returns |J u - v| for a fraction of an increment: the miss if the flange moved linearly.
  double linear_miss(const JointVector& increment, double fraction) const noexcept;
  /// Returns the miss of a motion of the flange from one pose to another, in the metric of v.
  /// Precondition: it is a task of the flange.
  double true_miss(const Pose& from, const Pose& to) const noexcept;
  /// Returns damping |u|^2 of a fraction of an increment.
  double damping_cost(const JointVector& increment, double fraction) const noexcept;
};

/// Returns the task of moving the flange by a displacement. Weighs rotations by
/// options.orientation_weight.
JointTask flange_task(const ChainState& chain, const Twist& displacement,
                      const InstrumentOptions& options) noexcept;

/// Returns the task of moving the joints by dq (n), with weights (n, or empty).
JointTask joint_task(std::span<const double> desired, std::span<const double> weights) noexcept;

}  // namespace keepout
