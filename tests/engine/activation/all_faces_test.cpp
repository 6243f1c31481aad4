// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/all_faces.h"

#include <gtest/gtest.h>

#include "engine/activation/rule_fixture.h"
#include "meshes.h"

namespace keepout {
namespace {

TEST(AllFaces, EveryFaceInReachWhosePositiveSideTheTipIsOnIsActive) {
  const auto mesh = mesh_of("star_bumps");
  AllFaces rule;
  const Vec3 tip = mesh->vertex(17) * 1.02;
  const double radius = 15.0;
  const std::vector<HalfSpace> planes = planes_at(mesh, rule, tip, radius);

  std::size_t expected = 0;
  for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
    const ClosestPoint closest = closest_point(mesh->triangle(t), tip);
    const Vec3 normal = mesh->normal(t);
    if (closest.distance > radius || normal.dot(-closest.offset) < 0.0) continue;
    ASSERT_LT(expected, planes.size());
    EXPECT_EQ(planes[expected].source, t);
    EXPECT_EQ(planes[expected].normal, normal);
    EXPECT_DOUBLE_EQ(planes[expected].offset, normal.dot(closest.offset));
    ++expected;
  }
  EXPECT_EQ(planes.size(), expected);
  EXPECT_GT(expected, 20u);
}

TEST(AllFaces, TrianglesWithoutAnAreaArePassedOver) {
  const auto mesh = mesh_of(Surface{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)},
                                    {{0, 1, 2}, {0, 0, 1}, {0, 1, 3}}});
  AllFaces rule;
  const auto planes = planes_at(mesh, rule, {0.2, 0.2, 0.5}, 5.0);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_EQ(planes[0].source, 2u);
}

}  // namespace
}  // namespace keepout
