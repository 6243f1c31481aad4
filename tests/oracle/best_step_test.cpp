// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/best_step.h"

#include <span>

#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/robots.h"
#include "keepout/geometry/closest_point.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::test {
namespace {

using oracle::best_step;
using oracle::BestStep;

std::vector<TriangleId> within(const Mesh& mesh, const Vec3& point, double radius) {
  std::vector<TriangleId> out;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    if (closest_point(mesh.triangle(t), point).distance <= radius) out.push_back(t);
  }
  return out;
}

double distance(const Mesh& mesh, std::span<const TriangleId> triangles, const Vec3& point) {
  double least = infinity;
  for (const TriangleId t : triangles) {
    least = std::min(least, closest_point(mesh.triangle(t), point).distance);
  }
  return least;
}

/// Returns the least clearance on the motion, minus the margin.
double slack(const Mesh& mesh, std::span<const TriangleId> triangles, const Vec3& tip,
             const Vec3& motion, double margin) {
  constexpr int samples = 500;
  double least = infinity;
  for (int i = 0; i <= samples; ++i) {
    least = std::min(least, distance(mesh, triangles, tip + i * motion / samples) - margin);
  }
  return least;
}

/// Returns the best step near a surface. Fails unless the step is consistent and safe.
BestStep best(const Surface& surface, const Vec3& tip, const Vec3& desired, double margin) {
  const Mesh mesh(surface);
  const std::vector<TriangleId> all = within(mesh, tip, 1e9);
  BestStep step = best_step(mesh, all, tip, desired, margin);
  EXPECT_DOUBLE_EQ(step.cost, (step.motion - desired).norm());
  EXPECT_LE(step.bound, step.cost);
  EXPECT_GE(step.bound, step.cost - 1e-3 * desired.norm());
  EXPECT_GE(slack(mesh, all, tip, step.motion, std::min(margin, distance(mesh, all, tip))), -1e-9);
  return step;
}

Surface rectangle(const Vec3& center, const Vec3& u, const Vec3& v) {
  return {{center - u - v, center + u - v, center + u + v, center - u + v}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Returns a plate at z = 0, free on both sides.
Surface plate() { return rectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0}); }

Surface slot(double gap) {
  return together(moved(plate(), {0, 0, gap / 2}), moved(plate(), {0, 0, -gap / 2}));
}

void expect_motion(const BestStep& step, const Vec3& motion, double tolerance) {
  EXPECT_LE((step.motion - motion).norm(), tolerance)
      << step.motion.transpose() << " instead of " << motion.transpose();
}

TEST(BestStep, WhatIsFreeIsNotChanged) {
  const BestStep step = best(plate(), {0, 0, 1.5}, {1, 2, -0.5}, 1);
  EXPECT_EQ(step.motion, Vec3(1, 2, -0.5));
  EXPECT_EQ(step.cost, 0.0);
}

TEST(BestStep, NoDesireIsNoMotion) {
  EXPECT_EQ(best(plate(), {0, 0, 1.5}, {0, 0, 0}, 1).motion, Vec3::Zero());
}

TEST(BestStep, APlateIsProjectedOn) {
  expect_motion(best(plate(), {0, 0, 1.25}, {1, 2, -3}, 1), {1, 2, -0.25}, 1e-12);
}

TEST(BestStep, APlateInContactIsSlidOn) {
  expect_motion(best(plate(), {0.3, 0.1, 1}, {1, 2, -3}, 1), {1, 2, 0}, 1e-8);
  expect_motion(best(moved(plate(), {1e3, 1e3, 1e3}), {1e3, 1e3, 1000.1}, {0.1, 0.1, -1}, 0.1),
                {0.1, 0.1, 0}, 1e-9);
}

TEST(BestStep, APlateThatIsTooNearComesNoNearer) {
  expect_motion(best(plate(), {0, 0, 0.5}, {1, 2, -3}, 1), {1, 2, 0}, 1e-12);
}

TEST(BestStep, AValleyIsFollowed) {
  // The walls rise at 45 degrees on both sides of the y axis. The tip touches both.
  const Surface valley = together(rectangle({5, 0, 5}, {5, 0, 5}, {0, 10, 0}),
                                  rectangle({-5, 0, 5}, {-5, 0, 5}, {0, 10, 0}));
  expect_motion(best(valley, {0, 0, std::numbers::sqrt2}, {0.1, 0.5, -1}, 1), {0, 0.5, 0}, 1e-9);
}

TEST(BestStep, ACornerHolds) {
  const Surface corner = together(plate(), together(rectangle({0, 0, 0}, {10, 0, 0}, {0, 0, 10}),
                                                    rectangle({0, 0, 0}, {0, 10, 0}, {0, 0, 10})));
  expect_motion(best(corner, {1, 1, 1}, {-1, -0.5, -0.8}, 1), {0, 0, 0}, 1e-9);
  expect_motion(best(corner, {1.1, 1.1, 1.1}, {-1, -0.5, -0.8}, 1), {-0.1, -0.1, -0.1}, 1e-9);
}

TEST(BestStep, ASlotThatFitsExactlyLeavesItsMiddlePlane) {
  expect_motion(best(slot(0.5), {0, 0, 0}, {1, 0.5, 0.7}, 0.25), {1, 0.5, 0}, 1e-9);
}

TEST(BestStep, ASlotIsLimitedByTheNearerWall) {
  expect_motion(best(slot(0.52), {0, 0, 0.002}, {1, 0.5, -0.7}, 0.25), {1, 0.5, -0.012}, 1e-9);
}

/// Returns the distance of the end of a motion (1, 0) from a tangent through its start. The tangent
/// touches a circle of this radius at (ahead, aside).
double round_a_circle(double ahead, double aside, double radius) {
  return std::sin(std::atan2(aside, ahead) + std::asin(radius / std::hypot(ahead, aside)));
}

TEST(BestStep, TheShorterWayRoundAWallIsTaken) {
  // The wall ends 0.05 to the right of the desired motion and 0.15 to its left.
  const Surface wall = rectangle({0.5, 0.05, 0}, {0, 0.1, 0}, {0, 0, 10});
  const BestStep step = best(wall, {0, 0, 0}, {1, 0, 0}, 0.02);
  const double cost = round_a_circle(0.5, 0.05, 0.02);
  EXPECT_NEAR(step.cost, cost, 1e-6);
  EXPECT_NEAR(step.motion.y(), -cost * std::sqrt(1 - cost * cost), 1e-5);
}

TEST(BestStep, APointIsPassed) {
  const Surface point{{{0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}}, {{0, 1, 2}}};
  EXPECT_NEAR(best(point, {0, 0, 0}, {1, 0, 0}, 0.1).cost, 0.2, 1e-6);
  EXPECT_NEAR(best(moved(point, {0, 0.03, 0}), {0, 0, 0}, {1, 0, 0}, 0.1).cost,
              round_a_circle(0.5, -0.03, 0.1), 1e-6);
}

TEST(BestStep, AConvexEdgeOfACubeIsGoneRound) {
  // The edge is x = z = 50. The tip is above the top, and the desired motion goes over the edge and
  // down. The loss is the distance of its end from the tangent plane of the cylinder around the
  // edge.
  const Vec3 tip(49, 0, 50.5), desired(3, 0.4, -1.5);
  const double margin = 0.1;
  const Vec3 to_edge = Vec3(50, 0, 50) - tip;
  const double turn = std::asin(margin / to_edge.norm()) - std::asin(0.5 / to_edge.norm());
  const Vec3 normal(-std::sin(turn), 0, std::cos(turn));
  ASSERT_LT(normal.dot(desired), 0.0);
  expect_motion(best(make_cube(50), tip, desired, margin), desired - normal.dot(desired) * normal,
                1e-5);
}

TEST(BestStep, AConvexEdgeAndAVertexOfACubeAreRounded) {
  // The desired end is half a margin too close. The best end is straight outward from it.
  const double margin = 0.2;
  for (const Vec3& out : {Vec3(1, 0, 1), Vec3(1, 2, 1.5)}) {
    const Vec3 outward = out.normalized();
    const Vec3 feature(50, out.y() > 0 ? 50 : 7, 50);
    const Vec3 tip = feature + outward + Vec3(0.05, -0.02, 0.03);
    const Vec3 end = feature + margin * outward;
    const Vec3 desired = feature + 0.5 * margin * outward - tip;
    expect_motion(best(make_cube(50), tip, desired, margin), end - tip, 1e-5);
  }
}

TEST(BestStep, TrianglesOutOfReachDoNoHarm) {
  const Mesh mesh(make_shape("gear"));
  Random random(5);
  for (const Vec3& tip : surface_points(mesh, 5, 0.3, random)) {
    const Vec3 desired = random.direction();
    const double one = best_step(mesh, within(mesh, tip, 2), tip, desired, 0.2).cost;
    const double other = best_step(mesh, within(mesh, tip, 5), tip, desired, 0.2).cost;
    EXPECT_NEAR(one, other, 1e-4);
  }
}

/// Returns true if the motion is free, by marching in steps that the distance allows. May accept a
/// motion that grazes, but never rejects a free one.
bool is_free(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
             const Vec3& motion, double margin) {
  const double length = motion.norm();
  const double grazing = 1e-9 * length;
  if (distance(mesh, near, tip + motion) < margin - grazing) return false;
  for (double s = 0.0; s < length;) {
    const double room = distance(mesh, near, tip + s / length * motion) - margin;
    if (room < -grazing) return false;
    s += std::max(room, 1e-4 * length);
  }
  return true;
}

/// Returns one of `count` evenly distributed directions of the half-sphere about z (Fibonacci
/// lattice).
Vec3 lattice_direction(int i, int count) {
  const double z = (i + 0.5) / count, r = std::sqrt(1.0 - z * z);
  const double phi = 2.0 * std::numbers::pi * std::numbers::phi * i;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Returns the least cost of free motions in many directions; `cost` if no motion is cheaper.
double brute_force(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
                   const Vec3& desired, double margin, double cost) {
  constexpr int directions = 50'000;
  const auto turn = rotation_between(Vec3::UnitZ(), desired);
  for (int i = 0; i < directions; ++i) {
    const Vec3 u = turn * lattice_direction(i, directions);
    const double along = u.dot(desired);
    const double across2 = desired.squaredNorm() - along * along;
    if (across2 >= cost * cost) continue;
    // From this length on, a motion along u is cheaper.
    const double needed = along - std::sqrt(cost * cost - across2);
    if (!is_free(mesh, near, tip, needed * u, margin)) continue;
    double low = needed, high = along;
    for (int k = 0; k < 20; ++k) {
      const double middle = 0.5 * (low + high);
      (is_free(mesh, near, tip, middle * u, margin) ? low : high) = middle;
    }
    cost = (low * u - desired).norm();
  }
  return cost;
}

class BestStepOnShapes : public testing::TestWithParam<const char*> {};

TEST_P(BestStepOnShapes, IsSafeAndNoDirectionOfManyIsBetter) {
  const Mesh mesh(make_shape(GetParam()));
  Random random(11);
  for (int traversal = 0; traversal < trials(6); ++traversal) {
    const double length = random.uniform(0.5, 3.0);
    const double margin = random.uniform(0.1, 0.4);
    Vec3 tip = surface_points(mesh, 1, 1.05 * margin, random)[0];
    while (distance(mesh, within(mesh, tip, margin), tip) < margin) {
      tip = surface_points(mesh, 1, 1.05 * margin, random)[0];
    }
    // From the second step on, the tip is in contact with the triangle that limited the first step.
    const Vec3 drift = random.direction();
    for (int k = 0; k < 4; ++k) {
      const Vec3 desired = length * (drift + 0.5 * random.direction()).normalized();
      const std::vector<TriangleId> near = within(mesh, tip, length + margin);
      const BestStep step = best_step(mesh, near, tip, desired, margin);
      EXPECT_GE(slack(mesh, near, tip, step.motion, margin), -1e-9 * length);
      EXPECT_LE(step.cost - step.bound, 1.001e-4 * length);
      const double searched = brute_force(mesh, near, tip, desired, margin, step.cost);
      EXPECT_LE(step.cost, searched + 1e-4 * length) << "traversal " << traversal << ", step " << k;
      EXPECT_LE(step.bound, searched + 1e-9 * length)
          << "traversal " << traversal << ", step " << k;
      tip += step.motion;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, BestStepOnShapes,
                         testing::Values("cube", "sphere", "gear", "cortex", "thin_plates"),
                         by_name);

}  // namespace
}  // namespace keepout::test
