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
  named,  // the one that the user names; without a name, a chain drawn for each start
  slides  // the scenario's own: joints that slide along three axes
};

/// One kind of attack: the differences from an instrument that is led against one mesh. The same
/// code draws, runs and judges all scenarios.
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

/// Throws Error if there is no scenario of that name.
const Scenario& scenario_named(const std::string& name);

/// The motion of a mesh: it swings along one axis and about another, or approaches along one axis
/// and returns.
struct MeshMotion {
  Pose first = {};             // its pose in cycle 0
  Vec3 along = Vec3::UnitX();  // unit
  Vec3 about = Vec3::UnitX();  // unit, through the world's origin of `center`
  Vec3 center = Vec3::Zero();  // of the turn [length]
  double way = 0.0;            // the farthest along [length]
  double turn = 0.0;           // the farthest about [rad]
  double cycles = 1.0;         // of a quarter of a swing, or until it has come on all its way
  bool comes_on = false;       // steadily, instead of swinging

  bool is_still() const noexcept { return way == 0.0 && turn == 0.0; }
  Pose at(double cycle) const;
};

/// A mesh of a setup.
struct SetupMesh {
  std::shared_ptr<Scene> scene;
  double margin = 0.0;  // of its own; 0: that of the options [length]
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
  bool is_drawn = true;  // mesh or robot are others in the next setup
  /// A body that keeps the whole certified distance in every cycle, with or without a motion: the
  /// setup leaves it room and time to give way.
  std::optional<std::size_t> must_keep = std::nullopt;
};

/// Draws a setup of a scenario: empty if many tries find no start. `draw_mesh` returns the mesh of
/// the row, or one more of its kind. `options`: of the robot that was drawn.
std::optional<RobotSetup> draw_setup(
    const Scenario& scenario, const RobotUnderTest* named, double speed, Random& random,
    const std::function<std::shared_ptr<Scene>(Random&)>& draw_mesh,
    const std::function<InstrumentOptions(const Chain&)>& options);

}  // namespace keepout::app
