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
  double advance = 0.0;  // of the flange, along the tool as it is at the start [mm]
};

/// Draws problems by a rule that knows no planner, each with a solution that keeps twice the
/// margin:
///
/// 1. The instrument begins before a random place of the surface, 5 to 20 mm off it (find_start).
/// 2. From there a hand pushes, slides and turns it about (RobotHand), for 3000 certified steps.
/// 3. The goal is the place on its way that is farthest ahead, along the tool as it is at the
///    start, among those to which the straight motion of the joints leads through the mesh; to
///    within some 2 mm. Unless it is 30 mm ahead, another beginning is tried.
///
/// Throws Error when it finds too few.
std::vector<RobotProblem> draw_robot_problems(Scene& scene, const RobotUnderTest& robot,
                                              double margin, std::size_t count, std::uint64_t seed);

}  // namespace keepout::app
