// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/activation/convex_tool_rule.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/fixtures/random.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::test {

/// A tool's text, and what it must be.
struct ToolByName {
  std::string text;
  ConvexTool tool;
};

/// One of each form, but for files.
inline std::vector<ToolByName> tools_by_name() {
  const std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(1, 0, 2), Vec3(-1, 0, 2), Vec3(0, 1, 2)};
  return {{"sphere:1.5", ConvexTool::sphere(1.5)},
          {"capsule:0,0,0:2.5,0,2.5:0.5", ConvexTool::capsule({0, 0, 0}, {2.5, 0, 2.5}, 0.5)},
          {"box:-1,-0.5,-.25:1,5e-1,0.25", ConvexTool::box({{-1, -0.5, -0.25}, {1, 0.5, 0.25}})},
          {"blade:4:2:0.5", ConvexTool::box({{-1, -0.25, 0}, {1, 0.25, 4}})},
          {"hull:0,0,0:1,0,2:-1,0,2:0,1,2", ConvexTool::hull(corners)},
          {"hull:0,0,0:1,0,2:-1,0,2:0,1,2:0.25", ConvexTool::hull(corners, 0.25)}};
}

/// What the names stand for, put together by hand.
inline MotionConstraint by_hand(const std::shared_ptr<const Mesh>& mesh, const ConvexTool& tool,
                                std::string_view narrow_phase, double radius = 5.0) {
  return {mesh,
          make_index("wide_bvh", mesh),
          std::make_unique<ConvexToolRule>(tool, make_narrow_phase(narrow_phase, tool)),
          make_solver("active_set"),
          {.radius = radius, .margin = 0.2}};
}

/// Where a hand is that comes down on the top face of make_cube, at 50, and wanders over it below.
inline std::vector<Vec3> hand_over_cube(int cycles) {
  Random random(5);
  std::vector<Vec3> hand;
  Vec3 at(3, 4, 55);
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const double down = at.z() > 49.0 ? -0.4 : 0.0;
    at += 0.3 * random.direction() + Vec3(0, 0, down);
    hand.push_back(at);
  }
  return hand;
}

}  // namespace keepout::test
