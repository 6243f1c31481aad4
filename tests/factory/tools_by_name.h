// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/activation/convex_tool_rule.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::test {

/// Returns a text of each form except files, and the tool that it must give.
inline std::vector<std::pair<std::string, ConvexTool>> tools_by_name() {
  const std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(1, 0, 2), Vec3(-1, 0, 2), Vec3(0, 1, 2)};
  return {{"sphere:1.5", ConvexTool::sphere(1.5)},
          {"capsule:0,0,0:2.5,0,2.5:0.5", ConvexTool::capsule({0, 0, 0}, {2.5, 0, 2.5}, 0.5)},
          {"box:-1,-0.5,-.25:1,5e-1,0.25", ConvexTool::box({{-1, -0.5, -0.25}, {1, 0.5, 0.25}})},
          {"blade:4:2:0.5", ConvexTool::box({{-1, -0.25, 0}, {1, 0.25, 4}})},
          {"hull:0,0,0:1,0,2:-1,0,2:0,1,2:0.25", ConvexTool::hull(corners, 0.25)}};
}

/// Returns the shape "cube" of the keepout command.
inline std::shared_ptr<const Mesh> cube() {
  static const auto shared = std::make_shared<const Mesh>(make_cube(10.0));
  return shared;
}

struct ExpectedStep {
  Vec3 tip, desired;
  Status status;
  Vec3 motion;
};

/// Returns the steps of pushing a tool into the cube, with a constraint put together by hand.
inline std::vector<ExpectedStep> loop_by_hand(const ConvexTool& tool, std::string_view narrow_phase,
                                              int cycles = 40) {
  MotionConstraint guard(
      cube(), make_index("wide_bvh", cube()),
      std::make_unique<ConvexToolRule>(tool, make_narrow_phase(narrow_phase, tool)),
      make_solver("active_set"), {.radius = 5.0, .margin = 0.2});
  Random random(5);
  std::vector<ExpectedStep> loop;
  Vec3 tip(3, 4, 56);
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const Vec3 desired = Vec3(0, 0, -0.4) + 0.3 * random.direction();
    const Step step = guard.step({.tip = tip, .desired = desired});
    loop.push_back({tip, desired, step.status, step.motion});
    tip += step.motion;
  }
  return loop;
}

}  // namespace keepout::test
