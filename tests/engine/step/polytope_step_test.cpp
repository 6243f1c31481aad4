// SPDX-License-Identifier: BSD-3-Clause
// The free polytope that MotionConstraint returns.

#include "keepout/factory/guide_text.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "trials.h"

namespace keepout {
namespace {

bool allows(const Polytope& polytope, const Vec3& motion) {
  for (const HalfSpace& plane : polytope.planes) {
    if (plane.normal.dot(motion) < plane.offset) return false;
  }
  return true;
}

TEST(MotionConstraintPolytope, EveryMotionWithinItKeepsTheMargin) {
  const auto mesh = mesh_of("cortex");
  // Some of the places are inside, where the polytope is empty unless tips are taken as they are.
  auto guard = make_motion_constraint(
      mesh, {.options = {.tool_radius = 0.2, .margin = 0.1}, .inside = Inside::taken_as_is});
  oracle::SafetyOracle oracle(mesh);
  Random random(2);
  std::size_t free = 0;
  for (const Vec3& tip : surface_points(*mesh, 100, 0.5, random)) {
    const Polytope polytope = guard.free_polytope(tip, 2.0);
    ASSERT_TRUE(polytope.ok()) << polytope.reason();
    ASSERT_TRUE(allows(polytope, Vec3::Zero()));
    const double kept = std::min(0.3, oracle.distance(tip));
    for (int i = 0; i < 50; ++i) {
      const Vec3 motion = 2.0 * std::cbrt(random.uniform()) * random.direction();
      if (!allows(polytope, motion)) continue;
      ++free;
      ASSERT_FALSE(oracle.check(tip, tip + motion, kept - 1e-10).below);
    }
  }
  EXPECT_GT(free, 500u);
}

TEST(MotionConstraintPolytope, IsTheSameOnEachTarget) {
  const auto mesh = mesh_of("cortex");
  Random random(4);
  const std::vector<Vec3> tips = surface_points(*mesh, 50, 0.5, random);
  std::vector<HalfSpace> expected;
  on_each_simd_target([&] {
    auto guard = make_motion_constraint(mesh, {});
    std::vector<HalfSpace> got;
    for (const Vec3& tip : tips) {
      const Polytope polytope = guard.free_polytope(tip, 2.0);
      got.insert(got.end(), polytope.planes.begin(), polytope.planes.end());
    }
    if (expected.empty()) expected = got;
    EXPECT_GT(got.size(), 100u);
    EXPECT_TRUE(std::ranges::equal(got, expected, [](const HalfSpace& a, const HalfSpace& b) {
      return a.normal == b.normal && a.offset == b.offset && a.source == b.source;
    }));
  });
}

TEST(MotionConstraintPolytope, FarFromTheMeshIsTheWholeBall) {
  const auto mesh = mesh_of("cube");
  auto guard = make_motion_constraint(mesh, {});
  const Polytope polytope = guard.free_polytope(Vec3(0, 0, 70), 2.0);
  EXPECT_TRUE(polytope.ok());
  EXPECT_TRUE(polytope.planes.empty());
}

TEST(MotionConstraintPolytope, OfATipOnTheForbiddenSideAllowsNoMotion) {
  const auto mesh = mesh_of("cube");
  auto guard = make_motion_constraint(mesh, {});
  const double half = mesh->bounds().high.x();
  for (const Vec3& tip : {Vec3(0, 0, 0), Vec3(half - 0.01, 0, 0), Vec3(half - 5.0, 1, 2)}) {
    const Polytope polytope = guard.free_polytope(tip, 2.0);
    EXPECT_EQ(polytope.status, Status::inside);
    EXPECT_FALSE(allows(polytope, Vec3(1e-9, 0, 0)));
  }
  EXPECT_TRUE(guard.free_polytope(Vec3(half + 0.01, 0, 0), 2.0).ok());
  auto as_is = make_motion_constraint(mesh, {.inside = Inside::taken_as_is});
  EXPECT_TRUE(as_is.free_polytope(Vec3(0, 0, 0), 2.0).ok());
  auto open = make_motion_constraint(mesh_of("flat_plate"), {});
  EXPECT_TRUE(open.free_polytope(Vec3(0, 0, -5), 2.0).ok());
}

TEST(MotionConstraintPolytope, IsInsideWhereTheOracleSaysSo) {
  const auto mesh = mesh_of("cortex");
  auto guard = make_motion_constraint(mesh, {.options = {.tool_radius = 0.2, .margin = 0.1}});
  auto as_is = make_motion_constraint(
      mesh, {.options = {.tool_radius = 0.2, .margin = 0.1}, .inside = Inside::taken_as_is});
  oracle::SafetyOracle oracle(mesh);
  Random random(3);
  std::size_t inside = 0;
  for (const Vec3& tip : surface_points(*mesh, 200, 0.5, random)) {
    const Polytope polytope = guard.free_polytope(tip, 2.0);
    const bool is_inside = oracle.inside(tip).value();
    inside += is_inside ? 1 : 0;
    ASSERT_EQ(polytope.status, is_inside ? Status::inside : Status::free) << tip.transpose();
    if (is_inside) continue;
    EXPECT_EQ(polytope.planes.size(), as_is.free_polytope(tip, 2.0).planes.size());
  }
  EXPECT_GT(inside, 0u);
  EXPECT_LT(inside, 200u);
}

TEST(MotionConstraintPolytope, OfATipInsideIsNeverFreeHoweverSmallTheBudget) {
  const auto mesh = mesh_of("cortex");
  const Vec3 tip = mesh->bounds().center();
  for (std::size_t units = 1; units < 3000; units = units * 5 / 4 + 1) {
    auto guard = make_motion_constraint(mesh, {.capacity = {.work_units = units}});
    const Polytope polytope = guard.free_polytope(tip, 1.0);
    EXPECT_FALSE(polytope.ok()) << units << " units";
    EXPECT_FALSE(allows(polytope, Vec3(1e-9, 0, 0))) << units << " units";
  }
}

TEST(MotionConstraintPolytope, IsUnsupportedWithGuides) {
  const auto mesh = mesh_of("cube");
  auto guard = make_motion_constraint(mesh, {});
  guard.set_guides({guide_of_text("ball:0,0,0:60")});
  EXPECT_EQ(guard.free_polytope(Vec3(0, 0, 70), 2.0).status, Status::unsupported);
  guard.set_guides({});
  EXPECT_TRUE(guard.free_polytope(Vec3(0, 0, 70), 2.0).ok());
}

TEST(MotionConstraintPolytope, FailuresAllowStandingStillOnly) {
  const auto mesh = mesh_of("sphere");
  auto guard = make_motion_constraint(mesh, {});
  auto small = make_motion_constraint(mesh, {.capacity = {.triangles = 10}});
  const auto expect_still = [](const Polytope& polytope, Status status) {
    EXPECT_EQ(polytope.status, status);
    EXPECT_FALSE(polytope.ok());
    EXPECT_FALSE(polytope.reason().empty());
    EXPECT_TRUE(allows(polytope, Vec3::Zero()));
    EXPECT_FALSE(allows(polytope, Vec3(1e-9, 0, 0)));
    EXPECT_FALSE(allows(polytope, Vec3(0, -1e-9, 0)));
  };
  expect_still(guard.free_polytope(Vec3(test::nan, 0, 0), 1.0), Status::invalid_input);
  expect_still(guard.free_polytope(Vec3(0, 0, 60), test::nan), Status::invalid_input);
  expect_still(guard.free_polytope(Vec3(0, 0, 60), -1.0), Status::invalid_input);
  expect_still(guard.free_polytope(mesh->vertex(0), 1.0), Status::touching);
  expect_still(small.free_polytope(Vec3(0, 0, 55), 20.0), Status::over_capacity);
}

}  // namespace
}  // namespace keepout
