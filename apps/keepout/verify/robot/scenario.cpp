// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/scenario.h"

#include <algorithm>
#include <array>

#include "keepout/error.h"

namespace keepout::app {

std::span<const Scenario> scenarios() {
  static const std::array<Scenario, 12> all{{
      {.name = "approach", .description = "led to the surface, and all about it"},
      {.name = "raised",
       .description = "approach, while the margin is raised every other 500 cycles",
       .raises_margin = true},
      {.name = "overlapping",
       .description = "begins with the surface within a body, by up to half its radius",
       .begin = Begin::overlapping},
      {.name = "wedged",
       .description = "begins between two walls, where the margin is raised at once",
       .begin = Begin::wedged,
       .raises_margin = true},
      {.name = "guides",
       .description = "one to three guides of points, axes and shafts, which may contradict",
       .has_guides = true},
      {.name = "blade",
       .description = "a convex blade of 3 to 8 points on the last link",
       .has_blade = true},
      {.name = "moving", .description = "the mesh swings and turns", .moves = true},
      {.name = "meshes",
       .description = "up to three meshes that swing and turn, each with a margin of its own",
       .meshes = 3,
       .moves = true},
      {.name = "stuck",
       .description = "a mesh comes on; two bodies cannot give way, and the tool must",
       .moves = true,
       .has_stuck_bodies = true,
       .carrier = Carrier::slides},
      {.name = "unlimited",
       .description = "joints without limits of velocity",
       .has_velocity_limits = false},
      {.name = "tip_guides",
       .description = "a tip's ball, within one to three guides of its own",
       .has_guides = true,
       .attacked = Attacked::tip,
       .carrier = Carrier::slides},
      {.name = "convex_tool",
       .description = "a convex tool that keeps its orientation",
       .attacked = Attacked::convex_tool,
       .carrier = Carrier::slides},
  }};
  return all;
}

const Scenario& scenario_named(const std::string& name) {
  const auto all = scenarios();
  const auto found = std::ranges::find(all, name, &Scenario::name);
  if (found == all.end()) throw Error("there is no scenario '" + name + "'");
  return *found;
}

}  // namespace keepout::app
