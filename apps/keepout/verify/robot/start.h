// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "verify/robot/robots.h"
#include "verify/scene.h"

namespace keepout::app {

/// The position of an instrument relative to the surface when a run begins.
enum class Begin : std::uint8_t {
  apart,        // before the surface, all bodies clear
  overlapping,  // with the surface inside a body, by up to half its radius
  wedged        // between two walls
};

/// The start of an instrument.
struct RobotStart {
  Pose base;
  std::vector<double> positions;  // of the joints
};

/// Returns the smallest clearance of all bodies from the mesh; infinite beyond `reach`. [length]
double clearance(const monitor::JudgedRobot& robot, const RobotStart& start, const Scene& scene,
                 double reach);

/// Draws a start whose bodies maintain the margin, unless they must overlap; empty if many tries
/// find no start. `ahead`: the largest distance of the tool from the surface, along the tool. [mm]
std::optional<RobotStart> find_start(Scene& scene, const RobotUnderTest& robot, Begin begin,
                                     double margin, Random& random, double ahead = 20.0);

/// An instrument beside a mesh, and its margin.
struct RobotScene {
  Scene scene;
  double margin;  // [mm]
  RobotUnderTest robot = robots_under_test().front();

  /// Draws a start farther from the mesh than `margins` margins; empty if no start is found.
  std::optional<RobotStart> start(Random& random, double margins = 1.0) {
    return find_start(scene, robot, Begin::apart, margins * margin, random);
  }
};

}  // namespace keepout::app
