// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "verify/robot/start.h"

namespace keepout::app {

/// An instrument beside a mesh, and its margin.
struct RobotScene {
  Scene scene;
  double margin;  // [mm]
  const RobotUnderTest& robot = robots_under_test().front();

  /// Draws a start apart from the mesh by more than so many margins; empty if it finds none.
  std::optional<RobotStart> start(Random& random, double margins = 1.0) {
    return find_start(scene, robot, Begin::apart, margins * margin, random);
  }
};

}  // namespace keepout::app
