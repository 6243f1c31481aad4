// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "verify/robot/start.h"

namespace keepout::app {

/// From where to where an instrument is to be led.
struct RobotProblem {
  std::size_t number = 0;  // from 1
  Pose base;
  std::vector<double> start = {}, goal = {};  // positions of the joints
  double advance = 0.0;  // of the flange, along the tool as it is at the goal [mm]
};

/// Draws problems by a rule that knows no planner, each with a solution that keeps twice the
/// margin:
///
/// 1. The goal is a random place where the tool is between two walls, with a millimetre or so of
///    room (find_start, wedged).
/// 2. From there the instrument is drawn back by 3000 certified steps, along the tool and aside,
///    and is turned, in a direction that changes every 100 steps.
/// 3. The start is the place on its way that is farthest back, along the tool as it is at the goal,
///    among those from which the straight motion of the joints to the goal leads through the mesh.
///    One less than 30 mm back is not taken, and another goal is tried.
///
/// Throws Error when it finds too few.
std::vector<RobotProblem> draw_robot_problems(
    Scene& scene, const std::shared_ptr<const oracle::TriangleTree>& tree,
    const RobotUnderTest& robot, double margin, std::size_t count, std::uint64_t seed);

}  // namespace keepout::app
