// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/oracle/judged_guide.h"
#include "keepout/robot/instrument_constraint.h"
#include "verify/robot/start.h"

namespace keepout::app {

/// The step that is attacked.
enum class Attacked : std::uint8_t {
  instrument,  // InstrumentConstraint
  tip,         // MotionConstraint with guides
  convex_tool  // MotionConstraint with ConvexToolRule
};

/// The robot that carries the bodies.
enum class Carrier : std::uint8_t {
  named,  // the robot that the user names, or else a chain drawn for each start
  slides  // prismatic joints along three axes, the scenario's own
};

/// One kind of attack: the differences from an instrument that is driven against one mesh. The same
/// code draws, runs and judges all scenarios.
struct Scenario {
  std::string_view name;
  std::string_view description;
  Begin begin = Begin::apart;
  bool raises_margin = false;     // every other 500 cycles
  std::size_t meshes = 1;         // largest number
  bool moves = false;             // the meshes move
  bool has_guides = false;        // one to three
  bool has_blade = false;         // another body, of 3 to 8 points
  bool has_stuck_bodies = false;  // on the base and at a joint's limit, before an approaching mesh
  bool has_velocity_limits = true;  // of the joints
  Attacked attacked = Attacked::instrument;
  Carrier carrier = Carrier::named;
};

/// Returns all scenarios. A campaign that names no scenario runs the first four.
std::span<const Scenario> scenarios();
inline constexpr std::size_t usual_scenarios = 4;

/// Returns the scenario of this name. Throws Error if it does not exist.
const Scenario& scenario_named(const std::string& name);

/// The motion of a mesh: it swings along one axis and about another, or approaches along one axis
/// and returns.
struct MeshMotion {
  Pose first = {};             // pose in cycle 0
  Vec3 along = Vec3::UnitX();  // unit
  Vec3 about = Vec3::UnitX();  // unit; passes through `center`
  Vec3 center = Vec3::Zero();  // of the turn [length]
  double way = 0.0;            // largest displacement [length]
  double turn = 0.0;           // largest rotation [rad]
  double cycles = 1.0;         // of a quarter of a swing, or of a complete approach
  bool comes_on = false;       // approaches steadily instead of swinging

  bool is_still() const noexcept { return way == 0.0 && turn == 0.0; }
  Pose at(double cycle) const;
};

/// A mesh of a setup.
struct SetupMesh {
  std::shared_ptr<Scene> scene;
  double margin = 0.0;  // own margin; 0: the margin of the options [length]
  MeshMotion motion = {};
};

/// The guarded robot, the meshes and guides, and the start of one attempt.
struct RobotSetup {
  const Scenario* scenario;
  RobotUnderTest robot;
  RobotStart start;
  std::vector<SetupMesh> meshes;
  std::vector<oracle::JudgedGuide> guides = {};
  InstrumentOptions options = {};
  double speed = 1.0;
  bool is_drawn = true;  // mesh or robot change with each setup
  /// A body that must maintain all of its certified clearance in every cycle, even without a
  /// motion: the setup gives it enough space and time to retreat.
  std::optional<std::size_t> must_keep = std::nullopt;
};

/// Draws a setup of a scenario; empty if many tries find no start. `draw_mesh` returns the mesh of
/// the row, or another one of its kind. `options`: for the drawn robot.
std::optional<RobotSetup> draw_setup(
    const Scenario& scenario, const RobotUnderTest* named, double speed, Random& random,
    const std::function<std::shared_ptr<Scene>(Random&)>& draw_mesh,
    const std::function<InstrumentOptions(const Chain&)>& options);

}  // namespace keepout::app
