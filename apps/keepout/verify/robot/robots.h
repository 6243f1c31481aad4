// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/monitor/judged_robot.h"
#include "keepout/robot/instrument.h"

namespace keepout::app {

/// A robot of campaigns, defined twice: for the library and for the judge.
struct RobotUnderTest {
  struct Range {
    double low, high;
  };
  std::string name;
  std::string description;
  std::vector<Joint> joints = {};
  Pose flange = {};
  std::vector<Body> bodies = {};
  monitor::JudgedRobot model = {};  // the same robot in the form of the judge
  std::vector<Range> starts = {};   // start range of each joint [rad or length]

  /// Returns the instrument on a base.
  Instrument make(const Pose& base) const { return {Chain(joints, base, flange), bodies}; }
  const monitor::JudgedRobot& judged() const noexcept { return model; }
  /// Returns true if the first body is a shaft that passes through a port of the base.
  bool has_port() const noexcept;
};
std::span<const RobotUnderTest> robots_under_test();

/// Returns the robot of this name. Throws Error if it does not exist.
const RobotUnderTest& robot_named(const std::string& name);

/// Returns the robot of this name, or that of a URDF file: see read_robot. Its tool is its last
/// body, and the end of the tool is the last point of that body. Joints start in the middle six
/// tenths of their range, at most 1 rad to each side. Prints notices on stderr. Throws Error, also
/// if this build reads no URDF, or if the robot of a name has a file of bodies.
RobotUnderTest chosen_robot(const std::string& robot, const std::filesystem::path& bodies);

/// Draws a chain of 3 to 7 joints, with any twists and with offsets up to 60 mm. It has one to
/// three bodies: balls, capsules and blades, some of radius 0.
RobotUnderTest drawn_robot(Random& random);

/// Draw three joints that slide along orthogonal axes, and the tool: a ball, or the hull of up to 8
/// points.
RobotUnderTest sliding_ball(Random& random);
RobotUnderTest sliding_hull(Random& random);

/// Draws four sliding joints. The last three carry the tool, which can retreat in every direction.
/// The first carries a body, and is at its upper limit when a mesh approaches along its axis.
/// Another body is on the base.
RobotUnderTest robot_with_stuck_bodies(Random& random);

/// Returns the robot with a blade of 3 to 8 points on its last link, as the last body.
RobotUnderTest with_blade(RobotUnderTest robot, Random& random);

/// Returns the robot without velocity limits.
RobotUnderTest without_velocity_limits(RobotUnderTest robot);

}  // namespace keepout::app
