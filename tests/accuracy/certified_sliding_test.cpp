// SPDX-License-Identifier: BSD-3-Clause
// Sliding is smooth: inner edges make no bumps, and no motion away from the surface is limited.

#include <Eigen/Geometry>

#include "accuracy/certified_loop.h"

namespace keepout::test::certified_sliding {
namespace {

struct Plate {
  const char* name;
  double margin;
  double rotation;  // about a generic axis [rad]
  int refinements;
};

void PrintTo(const Plate& plate, std::ostream* out) { *out << plate.name; }

class CertifiedSliding : public testing::TestWithParam<Plate> {};

TEST_P(CertifiedSliding, OverAFlatPlateIsSmoothAndUnhindered) {
  const Plate& plate = GetParam();
  const Eigen::Matrix3d frame =
      Eigen::AngleAxisd(plate.rotation, Vec3(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  Surface surface = make_flat_plate(1.25, 7);
  for (Vec3& v : surface.vertices) v = frame * v;
  constexpr double size = 100.0;
  Loop loop(std::move(surface),
            {.options = {.radius = 1.0, .margin = plate.margin, .refinements = plate.refinements},
             .capacity = {.planes = 200}});
  const Vec3 up = frame.col(2);

  Vec3 tip = frame * Vec3(1.0, 2.0, plate.margin + 0.5);
  Vec3 along = frame * Vec3(0.31, 0.17, 0.0);
  double lowest = 1e9, highest = -1e9, slowest = 0.0, sideways = 0.0;
  std::size_t other = 0;
  for (int cycle = 0; cycle < 10'000; ++cycle) {
    // The motion turns back at the rim, at an angle that does not repeat.
    const Vec3 local = frame.transpose() * tip;
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(local[axis]) > 45.0 && local[axis] * frame.col(axis).dot(along) > 0.0) {
        along -= 2.0 * frame.col(axis).dot(along) * frame.col(axis);
        along = Eigen::AngleAxisd(0.01 * cycle, up) * along;
      }
    }
    if (std::abs(local.x()) > 47.0 || std::abs(local.y()) > 47.0) {
      along = -local.x() * frame.col(0) - local.y() * frame.col(1);
      along *= 0.35 / along.norm();
    }
    const double press = 0.05 + 0.4 * (0.5 + 0.5 * std::sin(0.1 * cycle));
    const Vec3 desired = along - press * up;
    const Step step = loop.step(tip, desired);
    if (cycle < 20) {  // not in contact yet
      ASSERT_TRUE(step.ok());
      tip += step.motion;
      continue;
    }
    if (step.status != Status::limited) ++other;
    const Vec3 tangential = step.motion - up.dot(step.motion) * up;
    slowest = std::max(slowest, (along - tangential).dot(along) / along.squaredNorm());
    sideways = std::max(sideways, (along - tangential).norm() / along.norm());
    tip += step.motion;
    const double height = up.dot(tip);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  EXPECT_EQ(other, 0u) << "cycles that were not simply limited";
  EXPECT_LE(highest - lowest, 1e-9 * size);
  EXPECT_NEAR(lowest, plate.margin, 1e-9 * size);
  EXPECT_LE(slowest, 1e-9) << "fraction of the tangential motion that was lost";
  EXPECT_LE(sideways, 1e-9) << "fraction of the tangential motion that was deflected";
}

INSTANTIATE_TEST_SUITE_P(Plates, CertifiedSliding,
                         testing::Values(Plate{"straight_small_margin", 1e-3, 0.0, 3},
                                         Plate{"straight_medium_margin", 0.2, 0.0, 3},
                                         Plate{"straight_large_margin", 5.0, 0.0, 3},
                                         Plate{"rotated_small_margin", 1e-3, 0.7, 3},
                                         Plate{"rotated_medium_margin", 0.2, 0.7, 3},
                                         Plate{"rotated_large_margin", 5.0, 0.7, 3},
                                         Plate{"straight_unrefined", 0.2, 0.0, 0},
                                         Plate{"rotated_unrefined", 0.2, 0.7, 0}),
                         by_name);

class CertifiedRetreat : public testing::TestWithParam<Shape> {};

/// Returns true if a motion comes no nearer to any triangle. A distance is convex along the motion:
/// if it does not decrease at first, it never does.
bool leads_away(const std::vector<Vec3>& away, const Vec3& motion) {
  return std::all_of(away.begin(), away.end(),
                     [&](const Vec3& n) { return n.dot(motion) >= 1e-9 * motion.norm(); });
}

TEST_P(CertifiedRetreat, IsNeverSlowed) {
  constexpr double radius = 1.0, margin = 0.25;
  Loop loop(GetParam().make(), {.options = {.radius = radius, .margin = margin},
                                .inside = Inside::taken_as_is,
                                .capacity = {.planes = 200}});
  const PdTree tree(loop.shared_mesh());
  TriangleBuffer near(loop.mesh().triangle_count());
  Random random(9);
  std::size_t contacts = 0, retreats = 0, within_tolerance = 0;
  for (Vec3 tip : surface_points(loop.mesh(), 150, 1.5 * margin, random)) {
    if (loop.distance(tip) < margin) continue;
    const Vec3 press = loop.towards_surface(tip);
    Vec3 desired = random.uniform(0.3, 0.8) * (press + 0.5 * random.direction());
    Step step;
    for (int i = 0; i < 4; ++i) {
      step = loop.step(tip, 0.6 * desired);
      ASSERT_TRUE(step.ok()) << step.reason();
      tip += step.motion;
      if (step.status == Status::limited) desired = -0.7 * random.direction();
    }
    const double distance = loop.distance(tip);
    if (distance > margin + 1e-6) continue;
    ++contacts;
    if (distance < margin - 2.75 * loop.tolerance(tip)) ++within_tolerance;

    near.clear();
    tree.collect({tip, radius + margin}, near);
    std::vector<Vec3> away;
    for (const TriangleId t : near) {
      const ClosestPoint closest = closest_point(loop.mesh().triangle(t), tip);
      if (closest.distance <= radius + margin) away.push_back(-closest.offset.normalized());
    }
    for (int i = 0; i < 200; ++i) {
      const Vec3 motion = random.uniform(1e-3, 1.0) * random.direction();
      if (!leads_away(away, motion)) continue;
      ++retreats;
      const Step off = loop.step(tip, motion);
      ASSERT_EQ(off.motion, motion) << name(off.status) << ", " << distance - margin;
      ASSERT_EQ(off.status, Status::free);
    }
  }
  EXPECT_GT(contacts, 5u);
  // In a furrow or a triangle soup there may be no retreat.
  if (GetParam().kind == ShapeKind::solid) {
    EXPECT_GT(retreats, 100u);
  }
  EXPECT_EQ(within_tolerance, 0u) << "closer than where recovery begins";
}

INSTANTIATE_TEST_SUITE_P(Shapes, CertifiedRetreat, testing::ValuesIn(shapes()), by_name);

}  // namespace
}  // namespace keepout::test::certified_sliding
