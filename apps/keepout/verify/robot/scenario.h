// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace keepout::app {

/// The position of an instrument relative to the surface when a run begins.
enum class Begin : std::uint8_t {
  apart,        // before the surface, all bodies clear
  overlapping,  // with the surface within a body, by up to half its radius
  wedged        // between two walls
};

/// The step that is attacked.
enum class Attacked : std::uint8_t {
  instrument,  // InstrumentConstraint
  tip,         // MotionConstraint with guides
  convex_tool  // MotionConstraint with ConvexToolRule
};

/// The robot that carries the bodies.
enum class Carrier : std::uint8_t {
  named,  // the one that the user names; without a name, a chain drawn anew for each start
  slides  // the scenario's own: joints that slide along three axes
};

/// One kind of attack: what differs from an instrument that is led against one mesh. All scenarios
/// are drawn (draw_setup), run and judged (RobotJudge) by the same code.
struct Scenario {
  std::string_view name;
  std::string_view description;
  Begin begin = Begin::apart;
  bool raises_margin = false;       // every other 500 cycles
  std::size_t meshes = 1;           // at most
  bool moves = false;               // the meshes do
  bool has_guides = false;          // one to three
  bool has_blade = false;           // one more body, of 3 to 8 points
  bool has_stuck_bodies = false;    // on the base and at a joint's limit, where a mesh comes on
  bool has_velocity_limits = true;  // of the joints
  Attacked attacked = Attacked::instrument;
  Carrier carrier = Carrier::named;
};

/// All scenarios. The first four are those of a campaign that names none.
std::span<const Scenario> scenarios();
inline constexpr std::size_t usual_scenarios = 4;

/// Throws Error when there is none of that name.
const Scenario& scenario_named(const std::string& name);

}  // namespace keepout::app
