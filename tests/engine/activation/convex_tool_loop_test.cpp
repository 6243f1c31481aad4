// SPDX-License-Identifier: BSD-3-Clause
// Closed loops: tools pushed at shapes, each motion judged by an arithmetic of its own.
#include "engine/activation/convex_tool_loop.h"

#include <gtest/gtest.h>

#include "engine/geometry/tools.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "random_places.h"

namespace keepout {
namespace {

using test::guard;
using test::margin;
using test::radius;
using test::shape;
using test::tiny;
using test::ToolJudge;

struct Pushed {
  int held = 0;     // steps that were not free
  int refused = 0;  // that ended without a motion
  double way = 0.0;
};

/// Pushes a tool at the shape from all sides; every motion keeps the margin.
Pushed push(const std::shared_ptr<const Mesh>& mesh, MotionConstraint& constraint,
            const ConvexTool& tool, int cycles, std::uint64_t seed) {
  ToolJudge judge(mesh, tool);
  Random random(seed);
  Pushed pushed;
  const Box& box = mesh->bounds();
  const double far = 0.5 * box.size().norm() + tool.bounding_ball().radius +
                     tool.bounding_ball().center.norm() + 1.0;
  Vec3 tip = Vec3::Zero();
  Vec3 goal = Vec3::Zero();
  for (int cycle = 0; cycle < cycles; ++cycle) {
    if (cycle % 80 == 0) tip = box.center() + far * random.direction();
    if (cycle % 40 == 0) {
      goal = box.low +
             box.size().cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
    }
    Vec3 desired = goal - tip + random.uniform(0.0, 2.0) * random.direction();
    if (desired.norm() > radius) desired *= radius / desired.norm();
    const Step step = constraint.step({.tip = tip, .desired = desired});
    pushed.held += step.status != Status::free;
    pushed.refused += !step.ok();
    const Vec3 next = tip + step.motion;
    if (!step.motion.isZero(0.0)) {
      EXPECT_GE(judge.clearance(tip, next, margin - tiny), margin - tiny)
          << "cycle " << cycle << ", " << step.reason();
    }
    pushed.way += step.motion.norm();
    tip = next;
  }
  return pushed;
}

TEST(ConvexToolLoop, NoToolComesNearerThanTheMarginOnAnyShape) {
  Random random(1);
  for (const std::string name :
       {"cube", "gear", "cortex", "thin_plates", "needles", "star_bumps"}) {
    const auto mesh = shape(name);
    for (const test::NamedTool& named : test::tools_of_each_kind(4.0, random)) {
      SCOPED_TRACE(name + " " + named.name);
      MotionConstraint constraint = guard(mesh, named.tool);
      const Pushed pushed = push(mesh, constraint, named.tool, 100, 2);
      EXPECT_GT(pushed.held, 10);
      EXPECT_EQ(pushed.refused, 0);
      EXPECT_GT(pushed.way, 25.0);
    }
  }
}

TEST(ConvexToolLoop, NoNarrowPhaseCanTakeTheToolIn) {
  const auto mesh = shape("gear");
  for (const NarrowPhaseBackend& backend : narrow_phase_backends()) {
    Random random(3);
    for (const test::NamedTool& named : test::tools_of_each_kind(4.0, random)) {
      SCOPED_TRACE(std::string(backend.name) + " " + named.name);
      MotionConstraint constraint = guard(mesh, named.tool, backend.make(named.tool));
      const Pushed pushed = push(mesh, constraint, named.tool, 60, 4);
      EXPECT_GT(pushed.way, 10.0);
    }
  }
}

/// Says anything but the truth.
class Liar final : public NarrowPhase {
 public:
  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override {
    const double nan = std::nan("");
    Separation s{1000.0, random_.direction(), position};
    switch (random_.below(8)) {
      case 0:
        s.normal = Vec3(nan, 0, 0);
        break;
      case 1:
        s.normal = Vec3::Zero();
        break;
      case 2:
        s.normal *= 1e200;
        break;
      case 3:
        s.normal *= 1e-200;
        break;
      case 4:
        s.distance = nan;
        break;
      case 5:
        s.normal = (triangle[0] - position).normalized();
        break;
      case 6:
        return NarrowPhaseAnswer::failed("of course");
      default:
        break;
    }
    return {s, {}};
  }

 private:
  Random random_{5};
};

TEST(ConvexToolLoop, ALyingNarrowPhaseCostsMotionAndNotSafety) {
  Random random(6);
  for (const std::string name : {"cube", "gear"}) {
    const auto mesh = shape(name);
    for (const test::NamedTool& named : test::tools_of_each_kind(4.0, random)) {
      SCOPED_TRACE(name + " " + named.name);
      MotionConstraint constraint = guard(mesh, named.tool, std::make_unique<Liar>());
      const Pushed pushed = push(mesh, constraint, named.tool, 160, 7);
      EXPECT_GT(pushed.way, 10.0);
    }
  }
}

TEST(ConvexToolLoop, JointsAreHeldToTheSamePlanes) {
  const auto mesh = shape("gear");
  Random random(8);
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 7);
  for (int i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = normal(random);
  for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
    SCOPED_TRACE(named.name);
    MotionConstraint constraint =
        guard(mesh, named.tool, nullptr, {.radius = radius, .margin = margin, .damping = 1e-6});
    ToolJudge judge(mesh, named.tool);
    Vec3 tip(30, 0, 40);
    int held = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
      const Vec3 desired = Vec3(0, 0, -1) + 0.5 * random.direction();
      const Step step = constraint.step({.tip = tip, .desired = desired, .jacobian = jacobian});
      held += step.status != Status::free;
      if (step.motion.isZero(0.0)) continue;
      ASSERT_GE(judge.clearance(tip, tip + step.motion, margin - tiny), margin - tiny);
      tip += step.motion;
    }
    EXPECT_GT(held, 10);
  }
}

TEST(ConvexToolLoop, GuidesHoldAsWell) {
  const auto mesh = shape("gear");
  const auto vertices = mesh->vertices();
  const Vec3 top = *std::ranges::max_element(vertices, {}, [](const Vec3& v) { return v.z(); });
  const Vec3 start = top + Vec3(0, 0, 8.0);
  const Guide corridor = Guide::point("corridor", Region::tube(start, Vec3::UnitZ(), 1.0));
  Random random(9);
  for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
    SCOPED_TRACE(named.name);
    MotionConstraint constraint = guard(mesh, named.tool);
    constraint.set_guides({corridor});
    ToolJudge judge(mesh, named.tool);
    Vec3 tip = start;
    int held = 0, guided = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
      const Vec3 desired = Vec3(0.2, 0, -0.6) + 0.7 * random.direction();
      const Step step = constraint.step({.tip = tip, .desired = desired});
      held += step.limits.has(Limit::mesh);
      guided += step.limits.has(Limit::guide);
      const Vec3 next = tip + step.motion;
      ASSERT_LE(corridor.region().excess(next), corridor.band() + 1e-9);
      if (!step.motion.isZero(0.0)) {
        ASSERT_GE(judge.clearance(tip, next, margin - tiny), margin - tiny) << step.reason();
      }
      tip = next;
    }
    EXPECT_GT(held, 10);
    EXPECT_GT(guided, 10);
  }
}

}  // namespace
}  // namespace keepout
