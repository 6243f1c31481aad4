// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>

#include "engine/geometry/tools.h"
#include "keepout/activation/convex_tool_rule.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

TEST(ConvexToolAllocation, AStepAllocatesNothingWhateverItsOutcome) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  Random random(1);
  for (const test::NamedTool& named : test::tools_of_each_kind(2.0, random)) {
    MotionConstraint constraint(mesh, std::make_unique<PdTree>(mesh),
                                std::make_unique<ConvexToolRule>(named.tool),
                                std::make_unique<ActiveSet>(), {.radius = 2.0, .margin = 0.3});
    const double reach = named.tool.bounding_ball().center.norm() + named.tool.radius();
    std::size_t of_each[16] = {};
    for (const double offset : {0.2, 0.6, reach, 1.5 * reach + 1.0, 8.0}) {
      const std::vector<Vec3> tips = surface_points(*mesh, 100, offset, random);
      const std::size_t before = allocations();
      for (const Vec3& tip : tips) {
        const Vec3 desired = 1.9 * random.direction();
        ++of_each[static_cast<std::size_t>(
            constraint.step({.tip = tip, .desired = desired}).status)];
      }
      EXPECT_EQ(allocations(), before) << named.name;
    }
    for (const Status status :
         {Status::free, Status::limited, Status::recovering, Status::touching}) {
      EXPECT_GT(of_each[static_cast<std::size_t>(status)], 0u) << named.name << name(status);
    }
  }
}

}  // namespace
}  // namespace keepout
