// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/robot/instrument.h"
#include "verify/robot/scenario.h"
#include "verify/scene.h"

namespace keepout::app {

/// A robot that campaigns know, told twice: as the library has it, and as the judge has it.
struct RobotUnderTest {
  struct Range {
    double low, high;
  };
  std::string_view name;
  std::string_view description;
  std::function<Instrument(const Pose& base)> make;
  std::function<oracle::JudgedRobot()> judged;
  std::vector<Range> starts;  // of each joint, where motions begin [rad or length]
};
std::span<const RobotUnderTest> robots_under_test();

/// The one of a name. Throws Error when there is none.
const RobotUnderTest& robot_named(const std::string& name);

/// Where an instrument begins.
struct RobotStart {
  Pose base;
  std::vector<double> positions;  // of the joints
};

/// The smallest clearance of all bodies from the mesh; infinite beyond `reach`. [length]
double clearance(const oracle::JudgedRobot& robot, const RobotStart& start, const Scene& scene,
                 double reach);

/// Draws a start whose bodies keep the margin, unless they are to overlap; empty when many tries
/// find none. `ahead`: how far the tool is from the surface, at most, along its way. [mm]
std::optional<RobotStart> find_start(Scene& scene, const RobotUnderTest& robot, Begin begin,
                                     double margin, Random& random, double ahead = 20.0);

}  // namespace keepout::app
