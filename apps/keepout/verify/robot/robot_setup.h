// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/oracle/judged_guide.h"
#include "keepout/robot/instrument_constraint.h"
#include "verify/robot/scenario.h"
#include "verify/robot/start.h"

namespace keepout::app {

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

/// All that one attempt is made of: what is guarded, against what, and from where it begins.
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

/// Draws a setup of a scenario: empty when many tries find no place to begin. `draw_mesh` returns
/// the mesh of the row, or one more of its kind. `options`: of the robot that was drawn.
std::optional<RobotSetup> draw_setup(
    const Scenario& scenario, const RobotUnderTest* named, double speed, Random& random,
    const std::function<std::shared_ptr<Scene>(Random&)>& draw_mesh,
    const std::function<InstrumentOptions(const Chain&)>& options);

}  // namespace keepout::app
