// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/robot/instrument.h"
#include "verify/scene.h"

namespace keepout::app {

/// A robot that campaigns know, told twice: as the library has it, and as the judge has it.
struct RobotUnderTest {
  struct Range {
    double low, high;
  };
  std::string_view name;
  std::string_view description;
  Instrument (*make)(const Pose& base);
  oracle::JudgedRobot (*judged)();
  std::vector<Range> starts;  // of each joint, where motions begin [rad or length]
};
std::span<const RobotUnderTest> robots_under_test();

/// The one of a name. Throws Error when there is none.
const RobotUnderTest& robot_named(const std::string& name);

/// What is done with an instrument.
enum class Scenario : std::uint8_t {
  approach,     // it is led to the surface, and all about it
  raised,       // the same, while the margin is raised every other 500 cycles
  overlapping,  // it begins with the surface within a body, by up to half its radius
  wedged        // it begins between two walls, where the margin is raised at once
};
std::string_view name(Scenario scenario) noexcept;

/// Where an instrument begins.
struct RobotStart {
  Pose base;
  std::vector<double> positions;  // of the joints
};

/// A random one whose bodies keep the margin, but for the overlapping scenario; none when many
/// tries find none.
std::optional<RobotStart> find_start(Scene& scene,
                                     const std::shared_ptr<const oracle::TriangleTree>& tree,
                                     const RobotUnderTest& robot, Scenario scenario, double margin,
                                     Random& random);

}  // namespace keepout::app
