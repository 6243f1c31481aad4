// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "shared/columns.h"
#include "verify/robot/robot_scene.h"

namespace keepout::app {

/// States that straight motions join: of a tip its coordinates [mm], of an instrument the positions
/// of its joints.
using Path = std::vector<std::vector<double>>;

/// From where to where a tip or an instrument is to be led.
struct PlanningProblem {
  std::size_t number = 0;  // from 1
  std::vector<double> start = {}, goal = {};
  Pose base = {};     // of the instrument
  Json members = {};  // of its runs in the record: all of this, and how hard it is
};

/// The scene of a plan for a tip: a mesh, and its free side.
struct PlanningScene {
  enum class Space : std::uint8_t { within, around };
  enum class Starts : std::uint8_t {
    anywhere,
    below  // in the lowest tenth of the bounds, along z
  };

  Scene scene;
  Space space;
  Starts starts;
  Box bounds;  // of the state space [mm]
};

/// Loads a mesh or a fixture (named_mesh.h). The bounds are its own, and 10 mm more on all sides
/// where it is planned around.
PlanningScene load_planning_scene(const std::filesystem::path& mesh, PlanningScene::Space space,
                                  PlanningScene::Starts starts = PlanningScene::Starts::anywhere);

/// Draws problems for a tip by a rule that knows no planner, each with a solution that keeps the
/// clearance:
///
/// 1. A grid of 1/200 of the mesh's diagonal is flooded (FreeCells): around the mesh from a corner
///    of the bounds, within it from the widest of 1000 places drawn in it, in its lowest tenth
///    where starts are below.
/// 2. Start and goal are drawn evenly among the cells reached that are no farther from the mesh
///    than five times the clearance; starts as the scene has it.
/// 3. A pair is taken when the way along the grid is at least a quarter of the diagonal long and
///    1.3 times as long as in the open, and the straight way from one to the other touches the
///    mesh.
///
/// Throws Error when the rule finds too few.
std::vector<PlanningProblem> draw_problems(PlanningScene& where, double clearance,
                                           std::size_t count, std::uint64_t seed);

/// Draws problems for an instrument by a rule that knows no planner, each with a solution that
/// keeps twice the margin:
///
/// 1. The instrument begins before a random place of the surface, 5 to 20 mm off it (find_start).
/// 2. From there a hand pushes, slides and turns it about (Attacker), for 3000 certified steps.
/// 3. The goal is the place on its way that is farthest ahead, along the tool as it is at the
///    start, among those to which the straight motion of the joints leads through the mesh; to
///    within some 2 mm. Unless it is 30 mm ahead, another beginning is tried.
///
/// Throws Error when it finds too few.
std::vector<PlanningProblem> draw_problems(RobotScene& on, std::size_t count, std::uint64_t seed);

}  // namespace keepout::app
