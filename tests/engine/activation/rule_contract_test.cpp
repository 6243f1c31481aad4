// SPDX-License-Identifier: BSD-3-Clause
// Requirements on every rule of the registry, whichever planes it chooses.

#include <Eigen/Geometry>

#include "engine/activation/rule_fixture.h"
#include "keepout/activation/all_faces.h"
#include "keepout/activation/registry.h"
#include "keepout/fixtures/poses.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout {

static void PrintTo(const ActivationEntry& rule, std::ostream* out) { *out << rule.name; }

namespace {

class RuleContract : public testing::TestWithParam<ActivationEntry> {
 protected:
  /// Calls check(mesh, tip, planes) for tips close above every generated shape.
  template <class Check>
  void for_each_situation(double margin, Check&& check) const {
    for (const Shape& shape : shapes_to_try()) {
      SCOPED_TRACE(shape.name);
      const auto mesh = mesh_of(shape.make());
      const auto rule = GetParam().make();
      Random random(1);
      for (const Vec3& tip : surface_points(*mesh, 20, 0.5, random)) {
        check(*mesh, tip, planes_at(mesh, *rule, tip, 3.0, margin));
        if (HasFatalFailure()) return;
      }
    }
  }
};

/// Returns the distance by which rounding may move a corner out of the plane of its face. The
/// normal of a triangle with sides l and height h has an error of some epsilon l / h. [length]
double rounding_of_normal(const Triangle& t) {
  const double side = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  const double height = (t[1] - t[0]).cross(t[2] - t[0]).norm() / side;
  return 1e-15 * side * side / height;
}

TEST_P(RuleContract, NormalsAreUnitVectorsAndSourcesAreTrianglesInReach) {
  std::size_t seen = 0;
  for_each_situation(0.25, [&](const Mesh& mesh, const Vec3& tip, const auto& planes) {
    for (const HalfSpace& plane : planes) {
      ASSERT_NEAR(plane.normal.norm(), 1.0, 1e-14);
      ASSERT_LT(plane.source, mesh.triangle_count());
      ASSERT_LE(closest_point(mesh.triangle(plane.source), tip).distance, 3.25);
      ++seen;
    }
  });
  EXPECT_GT(seen, test::trials(1000u));
}

TEST_P(RuleContract, WithoutAMarginStandingStillIsAlwaysAllowed) {
  for_each_situation(0.0, [&](const Mesh&, const Vec3& tip, const auto& planes) {
    for (const HalfSpace& plane : planes) ASSERT_LE(plane.offset, 1e-12 * tip.lpNorm<1>());
  });
}

TEST_P(RuleContract, EachPlaneHasItsOwnTriangleBehindIt) {
  for_each_situation(0.25, [&](const Mesh& mesh, const Vec3& tip, const auto& planes) {
    for (const HalfSpace& plane : planes) {
      const Triangle triangle = mesh.triangle(plane.source);
      // The required clearance, or the present distance if that is smaller.
      const double kept = std::min(0.25, closest_point(triangle, tip).distance);
      for (const Vec3& corner : triangle) {
        ASSERT_LE(plane.normal.dot(corner - tip) + kept,
                  plane.offset + 1e-12 + rounding_of_normal(triangle));
      }
    }
  });
}

TEST_P(RuleContract, TheSameQuestionGetsTheSameAnswer) {
  const auto mesh = mesh_of("cortex");
  const auto rule = GetParam().make();
  Random random(2);
  for (const Vec3& tip : surface_points(*mesh, 50, 0.5, random)) {
    const auto first = planes_at(mesh, *rule, tip, 4.0);
    planes_at(mesh, *rule, -tip, 4.0);
    const auto second = planes_at(mesh, *rule, tip, 4.0);
    ASSERT_TRUE(std::equal(first.begin(), first.end(), second.begin(), second.end(),
                           [](const HalfSpace& a, const HalfSpace& b) {
                             return a.normal == b.normal && a.offset == b.offset &&
                                    a.source == b.source;
                           }));
  }
}

INSTANTIATE_TEST_SUITE_P(Rules, RuleContract, testing::ValuesIn(activation_rules()), by_name);

TEST(RuleRegistry, AnUnknownNameListsTheKnownOnes) {
  const std::string message = error_of([] { make_activation("papr"); });
  for (const ActivationEntry& rule : activation_rules()) EXPECT_CONTAINS(message, rule.name);
}

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
