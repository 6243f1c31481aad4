// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/convex_tool_rule.h"

#include <gtest/gtest.h>

#include "engine/activation/convex_tool_loop.h"
#include "keepout/activation/certified.h"
#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "keepout/index/brute_force.h"
#include "step/input.h"

namespace keepout {
namespace {

using test::guard;
using test::margin;
using test::radius;
using test::shape;
using test::tiny;
using test::ToolJudge;

TEST(ConvexToolRule, ASphereMovesAsAPointWithAsMuchMoreMargin) {
  for (const std::string name : {"star_bumps", "gear", "saddle_terrain"}) {
    const auto mesh = shape(name);
    const double r = 1.5;
    MotionConstraint ours = guard(mesh, ConvexTool::sphere(r), nullptr,
                                  {.radius = radius, .margin = margin, .refinements = 0});
    MotionConstraint points{mesh,
                            std::make_unique<PdTree>(mesh),
                            std::make_unique<CertifiedRule>(),
                            std::make_unique<ActiveSet>(),
                            {.radius = radius, .margin = margin + r, .refinements = 0}};
    Random random(9);
    Vec3 tip(60, 10, 30);
    int held = 0;
    for (int cycle = 0; cycle < 300; ++cycle) {
      const Vec3 desired = 0.5 * (Vec3::Zero() - tip).normalized() + 0.8 * random.direction();
      const Step step = ours.step({.tip = tip, .desired = desired});
      const Step other = points.step({.tip = tip, .desired = desired});
      ASSERT_TRUE(step.ok()) << step.reason();
      ASSERT_NEAR((step.motion - other.motion).norm(), 0.0, 1e-6) << name << " " << cycle;
      held += step.status != Status::free;
      tip += step.motion;
    }
    EXPECT_GT(held, 10);
  }
}

TEST(ConvexToolRule, AsksForNoPolytopeAroundTheTipAlone) {
  // A shaft below the tip: free space around the tip says nothing of it.
  MotionConstraint shaft = guard(shape("cube"), ConvexTool::capsule({0, 0, 0}, {0, 0, -10}, 0.5),
                                 nullptr, {.radius = radius, .margin = margin});
  const Polytope polytope = shaft.free_polytope(Vec3(0, 0, 61), 5.0);
  EXPECT_EQ(polytope.status, Status::unsupported);
  EXPECT_FALSE(polytope.ok());
  // What is returned all the same allows standing still only.
  EXPECT_EQ(polytope.planes.size(), planes_to_hold_still);
}

TEST(ConvexToolRule, IsNotLedOutByItsTip) {
  const auto mesh = shape("cube");
  const auto make = [&](Inside inside) {
    return MotionConstraint(mesh, std::make_unique<PdTree>(mesh),
                            std::make_unique<ConvexToolRule>(ConvexTool::sphere(1.0)),
                            std::make_unique<ActiveSet>(), {.radius = radius, .margin = margin}, {},
                            inside);
  };
  EXPECT_THROW(make(Inside::led_out), Error);
  EXPECT_NO_THROW(make(Inside::taken_as_is));
}

TEST(ConvexToolRule, ASpheresPlanesAreThoseThroughTheClosestPoints) {
  const auto mesh = shape("star_bumps");
  const double r = 1.5;
  ConvexToolRule rule(ConvexTool::sphere(r));
  const Vec3 tip = mesh->vertex(17) * 1.1;
  const RuleInput input =
      rule_input_of({.tip = tip, .desired = Vec3::Zero()}, {.radius = 5.0, .margin = margin},
                    EndRegion::motion_sphere);
  Budget budget;
  Neighborhood near(mesh, std::make_shared<BruteForce>(mesh), mesh->triangle_count(), budget);
  rule.prepare(near);
  EXPECT_GT(rule.region(input).radius, 5.0 + margin + r);
  ASSERT_TRUE(rule.gather(input));
  HalfSpaceBuffer planes(mesh->triangle_count());
  ASSERT_EQ(rule.open(input, planes).status, Status::free);
  EXPECT_TRUE(planes.empty());
  Random random(10);
  for (int i = 0; i < 100; ++i) {
    planes.clear();
    const Vec3 trial = 5.0 * random.direction();
    const Judgement judgement = rule.judge(input, trial, planes);
    if (judgement.verdict == Judgement::Verdict::accepted) continue;
    ASSERT_EQ(planes.size(), 1u);
    const HalfSpace& plane = planes[0];
    // At the contact the plane goes through the point nearest to the centre.
    const Vec3 there = tip + judgement.free_fraction * trial;
    const ClosestPoint closest = closest_point(mesh->triangle(plane.source), there);
    EXPECT_NEAR(closest.distance, r + margin, 1e-8);
    EXPECT_NEAR((plane.normal + closest.offset / closest.distance).norm(), 0.0, 1e-7);
    EXPECT_NEAR(plane.normal.dot(judgement.free_fraction * trial), plane.offset, 1e-7);
    for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
      EXPECT_GE(closest_point(mesh->triangle(t), there).distance, r + margin - 1e-8);
    }
  }
}

TEST(ConvexToolRule, ABoxSlidesAlongAFaceAtTheMargin) {
  const auto mesh = shape("cube");  // its faces are at +-50
  const ConvexTool box = ConvexTool::box({Vec3(-2, -1, -1), Vec3(2, 1, 3)});
  MotionConstraint constraint = guard(mesh, box);
  Vec3 tip(-30, 3, 60);
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Step step = constraint.step({.tip = tip, .desired = Vec3(0.5, 0, -0.5)});
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_NEAR(step.motion.x(), 0.5, 1e-9) << cycle;
    tip += step.motion;
  }
  EXPECT_NEAR(tip.z(), 50.0 + margin + 1.0, 1e-9);
}

TEST(ConvexToolRule, AToolThatIsTooCloseIsLedOffAndComesNoNearer) {
  const auto mesh = shape("cube");
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  MotionConstraint constraint = guard(mesh, box);
  ToolJudge judge(mesh, box);
  Vec3 tip(0, 0, 50 + 1 + 0.01);
  double clearance = 0.01;
  for (int cycle = 0; cycle < 10; ++cycle) {
    const Step step = constraint.step({.tip = tip, .desired = Vec3(0.1, 0, -0.5)});
    ASSERT_TRUE(step.ok()) << step.reason();
    const Vec3 next = tip + step.motion;
    EXPECT_GE(judge.clearance(tip, next, clearance - tiny), clearance - tiny);
    tip = next;
    clearance = tip.z() - 51.0;
    if (clearance < margin - tiny) {
      EXPECT_EQ(step.status, Status::recovering);
    }
  }
  EXPECT_NEAR(clearance, margin, tiny);
}

TEST(ConvexToolRule, AToolTooCloseOnBothSidesStandsStill) {
  const auto mesh = shape("thin_plates");  // gaps of 1
  const Vec3 in_the_gap(0, 0, mesh->bounds().low.z() + 1.5);
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -0.4), Vec3(1, 1, 0.4)});
  MotionConstraint constraint = guard(mesh, box);
  ToolJudge judge(mesh, box);
  const Step step = constraint.step({.tip = in_the_gap, .desired = Vec3(0.5, 0, -0.5)});
  ASSERT_TRUE(step.ok()) << step.reason();
  const double least = 0.1 - tiny;
  EXPECT_GE(judge.clearance(in_the_gap, in_the_gap + step.motion, least), least);
}

TEST(ConvexToolRule, AToolThatTouchesOrOverlapsStandsStill) {
  const auto mesh = shape("cube");
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  MotionConstraint constraint = guard(mesh, box);
  for (const double height : {51.0, 50.5, 49.5}) {
    const Step step = constraint.step({.tip = Vec3(0, 0, height), .desired = Vec3(0, 0, 0.5)});
    EXPECT_EQ(step.status, Status::touching) << height;
    EXPECT_EQ(step.motion, Vec3::Zero());
  }
}

TEST(ConvexToolRule, WhatCannotBeKeptIsRefusedWhenItIsMade) {
  const auto mesh = shape("cube");
  const ConvexTool tool = ConvexTool::sphere(1.0);
  EXPECT_THROW(guard(mesh, tool, nullptr, {.radius = radius, .margin = 0.0}), Error);
  EXPECT_THROW(guard(mesh, tool, nullptr, {.radius = radius, .margin = 1e-12}), Error);
}

}  // namespace
}  // namespace keepout
