// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "verify/scene.h"

namespace keepout::app {

/// Where to plan: a mesh, and which side of it is free.
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

struct Problem {
  std::size_t number = 0;  // from 1
  Vec3 start, goal;        // [mm]
  double straight = 0.0;   // from the one to the other [mm]
  double detour = 1.0;     // a way there along the grid, as a multiple of the same in the open
};

/// Draws problems by a rule that knows no planner, each with a solution that keeps the clearance:
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
std::vector<Problem> draw_problems(PlanningScene& where, double clearance, std::size_t count,
                                   std::uint64_t seed);

}  // namespace keepout::app
