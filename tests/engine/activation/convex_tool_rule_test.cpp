// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/convex_tool_rule.h"

#include "engine/geometry/reference_separation.h"
#include "engine/geometry/tools.h"
#include "guards.h"
#include "keepout/activation/certified.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/error.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"
#include "step/input.h"
#include "trials.h"

namespace keepout {
namespace {

constexpr double margin = 0.2;
constexpr double radius = 2.0;
constexpr double tiny = 1e-8;  // far above the rule's tolerance, far below the margin

MotionConstraint guard(const std::shared_ptr<const Mesh>& mesh, const ConvexTool& tool,
                       std::unique_ptr<NarrowPhase> narrow_phase = nullptr,
                       StepOptions step_options = {.radius = radius, .margin = margin}) {
  return guard_of<PdTree>(mesh, step_options, std::make_unique<ActiveSet>(),
                          std::make_unique<ConvexToolRule>(tool, std::move(narrow_phase)));
}

/// Returns the distance that a plane proves, in long double: at most the true distance, for any
/// normal. [length]
double proven_by(const Vec3& normal, std::span<const Vec3> core, const Triangle& triangle) {
  using Real = long double;
  const auto along = [&](const Vec3& p) {
    return Real{normal.x()} * p.x() + Real{normal.y()} * p.y() + Real{normal.z()} * p.z();
  };
  Real low = std::numeric_limits<Real>::infinity();
  Real high = -low;
  for (const Vec3& p : core) low = std::min(low, along(p));
  for (const Vec3& v : triangle) high = std::max(high, along(v));
  return static_cast<double>((low - high) / std::sqrt(along(normal)));
}

/// Judges each motion of a tool against all triangles that it can reach. Uses only the index and
/// the proposed normals of the engine.
class ToolJudge {
 public:
  ToolJudge(std::shared_ptr<const Mesh> mesh, const ConvexTool& tool)
      : mesh_(mesh), tool_(tool), index_(mesh), candidates_(mesh->triangle_count()) {}

  /// Returns the least clearance on the motion, or a lower bound that is at least `enough`.
  /// [length]
  double clearance(const Vec3& from, const Vec3& to, double enough) {
    const Ball& bounds = tool_.bounding_ball();
    candidates_.clear();
    index_.collect({0.5 * (from + to) + bounds.center,
                    0.5 * (to - from).norm() + bounds.radius + enough + 1e-6},
                   candidates_);
    std::vector<Vec3> core;  // of the swept tool
    for (const Vec3& p : tool_.points()) core.insert(core.end(), {from + p, to + p});
    const ConvexTool swept = ConvexTool::hull(core);
    double least = test::infinity;
    for (const TriangleId t : candidates_) {
      const Triangle triangle = mesh_->triangle(t);
      double apart = proven_by(separation(swept, Vec3::Zero(), triangle).normal, core, triangle);
      if (!(apart - tool_.radius() >= enough)) apart = test::reference_separation(core, triangle);
      least = std::min(least, apart - tool_.radius());
    }
    return least;
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  ConvexTool tool_;
  PdTree index_;
  TriangleBuffer candidates_;
};

TEST(ConvexToolRule, ASphereMovesAsAPointWithAsMuchMoreMargin) {
  for (const std::string name : {"star_bumps", "gear", "saddle_terrain"}) {
    const auto mesh = mesh_of(name);
    const double r = 1.5;
    MotionConstraint ours = guard(mesh, ConvexTool::sphere(r), nullptr,
                                  {.radius = radius, .margin = margin, .refinements = 0});
    MotionConstraint points =
        guard_of<PdTree>(mesh, {.radius = radius, .margin = margin + r, .refinements = 0});
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
  // A shaft below the tip: free space around the tip does not prove the shaft clear.
  MotionConstraint shaft = guard(mesh_of("cube"), ConvexTool::capsule({0, 0, 0}, {0, 0, -10}, 0.5));
  const Polytope polytope = shaft.free_polytope(Vec3(0, 0, 61), 5.0);
  EXPECT_EQ(polytope.status, Status::unsupported);
  EXPECT_FALSE(polytope.ok());
  // The returned planes allow zero motion only.
  EXPECT_EQ(polytope.planes.size(), planes_to_hold_still);
}

TEST(ConvexToolRule, IsNotLedOutByItsTip) {
  const auto mesh = mesh_of("cube");
  const auto make = [&](Inside inside) {
    return MotionConstraint(mesh, std::make_unique<PdTree>(mesh),
                            std::make_unique<ConvexToolRule>(ConvexTool::sphere(1.0)),
                            std::make_unique<ActiveSet>(), {.radius = radius, .margin = margin}, {},
                            inside);
  };
  EXPECT_THROW(make(Inside::escape), Error);
  EXPECT_NO_THROW(make(Inside::taken_as_is));
}

TEST(ConvexToolRule, ASpheresPlanesAreThoseThroughTheClosestPoints) {
  const auto mesh = mesh_of("star_bumps");
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
    // At the contact, the center is on the plane, whose normal points away from the closest point.
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
  const auto mesh = mesh_of("cube");  // its faces are at +-50
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
  const auto mesh = mesh_of("cube");
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
  const auto mesh = mesh_of("thin_plates");  // gaps of 1
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
  const auto mesh = mesh_of("cube");
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  MotionConstraint constraint = guard(mesh, box);
  for (const double height : {51.0, 50.5, 49.5}) {
    const Step step = constraint.step({.tip = Vec3(0, 0, height), .desired = Vec3(0, 0, 0.5)});
    EXPECT_EQ(step.status, Status::touching) << height;
    EXPECT_EQ(step.motion, Vec3::Zero());
  }
}

TEST(ConvexToolRule, WhatCannotBeKeptIsRefusedWhenItIsMade) {
  const auto mesh = mesh_of("cube");
  const ConvexTool tool = ConvexTool::sphere(1.0);
  EXPECT_THROW(guard(mesh, tool, nullptr, {.radius = radius, .margin = 0.0}), Error);
  EXPECT_THROW(guard(mesh, tool, nullptr, {.radius = radius, .margin = 1e-12}), Error);
}

// Closed loops push tools at shapes; independent arithmetic judges each motion.

struct Pushed {
  int held = 0;     // steps that were not free
  int refused = 0;  // steps that ended without a motion
  double way = 0.0;
};

/// Pushes a tool at the shape from all sides. Checks that every motion maintains the margin.
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
    const auto mesh = mesh_of(name);
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
  const auto mesh = mesh_of("gear");
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

/// A narrow phase that returns wrong distances, wrong normals, NaN and failures.
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
    const auto mesh = mesh_of(name);
    for (const test::NamedTool& named : test::tools_of_each_kind(4.0, random)) {
      SCOPED_TRACE(name + " " + named.name);
      MotionConstraint constraint = guard(mesh, named.tool, std::make_unique<Liar>());
      const Pushed pushed = push(mesh, constraint, named.tool, 160, 7);
      EXPECT_GT(pushed.way, 10.0);
    }
  }
}

TEST(ConvexToolLoop, JointsAreHeldToTheSamePlanes) {
  const auto mesh = mesh_of("gear");
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
  const auto mesh = mesh_of("gear");
  const Vec3 start = highest_vertex(*mesh) + Vec3(0, 0, 8.0);
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
