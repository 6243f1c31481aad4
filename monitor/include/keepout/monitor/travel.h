// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"
#include "keepout/monitor/judged_robot.h"

namespace keepout::monitor {

/// A joint at one time of a motion, and its change in the whole motion.
struct JointLine {
  bool slides = false;
  double change = 0.0;         // of its position, >= 0 [rad or length]
  Vec3 origin = Vec3::Zero();  // a point of the axis, of a joint that turns [length]
  Vec3 axis = Vec3::UnitZ();   // unit
};

/// Returns the joint of a row, whose link has this pose.
JointLine joint_line(const TableRow& row, const LinkFrame& link, double change) noexcept;

/// Bounds on the motion p(s) of a point, s from 0 to 1. [length]
struct Travel {
  double speed = 0.0;  // >= |p'|
  double bend = 0.0;   // >= |p''|
};

/// Returns bounds on the motion of a point that a serial chain of joints carries, if all joints
/// move at constant speed from `start` to `end`. `start`, `end`: the joints from the base to the
/// point. `from`, `to`: the point at these times, in the same frame as the joints.
///
/// Let z be the axis of joint k, dq its change, and J dq the velocity that it gives to the point. J
/// is z for a joint that slides. For a joint that turns, |J| is the distance of the point from the
/// axis. Only later joints change this distance, at most by their sum of |J dq|. So it is at most
/// half of its values at start and end plus half of that sum. This gives |p'| <= sum of |J dq|,
/// from the last joint to the first.
///
/// The derivative of J of joint k by joint j is z_j x J_k if j is before k or is k, and turns. It
/// is 0 if j slides. By symmetry, it is z_k x J_j if j is after k. So |p''| is at most the sum over
/// all joints k that turn of |dq_k| (|J_k dq_k| + twice the sum of |J dq| of all later joints).
Travel travel(std::span<const JointLine> start, std::span<const JointLine> end, const Vec3& from,
              const Vec3& to) noexcept;

/// Returns the least value for u in [0, 1] of (1 - u) a + u b - bend u (1 - u) / 2. No height of a
/// point over a plane is less, if it is a at the start, b at the end, and `bend` bounds its second
/// derivative.
double least_between(double a, double b, double bend) noexcept;

}  // namespace keepout::monitor
