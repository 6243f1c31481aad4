// SPDX-License-Identifier: BSD-3-Clause
// Checks Table I of Li et al. (2020), corrected by its errata, case by case, and then the cases
// that the paper leaves open.
#include "keepout/activation/paper.h"

#include <gtest/gtest.h>

#include "engine/activation/rule_fixture.h"
#include "meshes.h"

namespace keepout {
namespace {

/// Returns two triangles with the free side above. T1 (left) and T2 (right), with the given apexes,
/// share the edge from (0, -2, 0) to (0, 2, 0).
std::shared_ptr<const Mesh> two_triangles(const Vec3& left, const Vec3& right) {
  return mesh_of(Surface{{Vec3(0, -2, 0), Vec3(0, 2, 0), left, right}, {{0, 1, 2}, {1, 0, 3}}});
}

std::shared_ptr<const Mesh> ridge(double height) {
  return two_triangles({-2, 0, -height}, {2, 0, -height});
}
std::shared_ptr<const Mesh> valley(double height) {
  return two_triangles({-2, 0, height}, {2, 0, height});
}

constexpr TriangleId t1 = 0;
constexpr TriangleId t2 = 1;
constexpr double far_enough = 20.0;

/// An entry of Table I, {normal, closest point} of a triangle. The test computes the closest point.
struct TableEntry {
  TriangleId triangle;
  Vec3 normal;
};

void expect_planes(const std::shared_ptr<const Mesh>& mesh, const Vec3& tip,
                   const std::vector<TableEntry>& expected) {
  PaperRule rule;
  const std::vector<HalfSpace> planes = planes_at(mesh, rule, tip, far_enough);
  ASSERT_EQ(planes.size(), expected.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const TableEntry& bracket = expected[i];
    const Vec3 to_closest = closest_point(mesh->triangle(bracket.triangle), tip).offset;
    EXPECT_EQ(planes[i].source, bracket.triangle);
    EXPECT_LT((planes[i].normal - bracket.normal).norm(), 1e-15);
    EXPECT_NEAR(planes[i].offset, bracket.normal.dot(to_closest), 1e-15);
    EXPECT_LE(planes[i].offset, 0.0) << "standing still must be allowed";
  }
}

Feature feature_of(const std::shared_ptr<const Mesh>& mesh, TriangleId t, const Vec3& tip) {
  return closest_point(mesh->triangle(t), tip).feature;
}

TEST(TableOne, ConvexA_OnlyTheFaceInFrontIsActiveAlthoughBothClosestPointsAreInTriangle) {
  const auto mesh = ridge(4.0);
  const Vec3 tip = Vec3(1, 0, -2) + 0.2 * mesh->normal(t2);
  ASSERT_TRUE(is_face(feature_of(mesh, t1, tip)) && is_face(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t2, mesh->normal(t2)}});
}

TEST(TableOne, ConvexB_TheFaceBehindTheRidgeIsNotActive) {
  const auto mesh = ridge(0.5);
  const Vec3 tip = Vec3(1, 0, -0.25) + 0.3 * mesh->normal(t2);
  ASSERT_TRUE(is_edge(feature_of(mesh, t1, tip)) && is_face(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t2, mesh->normal(t2)}});
}

TEST(TableOne, ConvexC_OverTheRidgeOnePlaneFacesTheTip) {
  const auto mesh = ridge(0.5);
  const Vec3 tip(0.05, 0.3, 1);
  ASSERT_TRUE(is_edge(feature_of(mesh, t1, tip)) && is_edge(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t1, Vec3(0.05, 0, 1).normalized()}});
}

TEST(TableOne, ConcaveA_BothFacesAreActive) {
  const auto mesh = valley(0.5);
  const Vec3 tip(0, 0, 1);
  expect_planes(mesh, tip, {{t1, mesh->normal(t1)}, {t2, mesh->normal(t2)}});
}

TEST(TableOne, ConcaveB_TheOtherFaceIsKeptThroughTheValley) {
  const auto mesh = valley(0.5);
  const Vec3 tip = Vec3(1, 0, 0.25) + 0.1 * mesh->normal(t2);
  ASSERT_TRUE(is_edge(feature_of(mesh, t1, tip)) && is_face(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t1, mesh->normal(t1)}, {t2, mesh->normal(t2)}});
}

TEST(TableOne, ConcaveC_BeyondTheRightTriangleOnlyTheLeftIsDecided) {
  const auto mesh = valley(0.5);
  const Vec3 tip(3, 0, 1);
  ASSERT_TRUE(is_edge(feature_of(mesh, t1, tip)) && is_vertex(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t1, mesh->normal(t1)}});
}

TEST(TableOne, ConcaveD_AboveTheLeftAndBeyondTheRight) {
  const auto mesh = two_triangles({-2, 0, 4}, {0.5, 0, 1});
  const Vec3 tip = Vec3(-1.6, 0, 3.2) + 0.2 * mesh->normal(t1);
  ASSERT_TRUE(is_face(feature_of(mesh, t1, tip)) && is_vertex(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {{t1, mesh->normal(t1)}});
}

TEST(TableOne, ConcaveE_BeyondBothNothingIsDecided) {
  const auto mesh = valley(4.0);
  const Vec3 tip(0, 0, 10);
  ASSERT_TRUE(is_vertex(feature_of(mesh, t1, tip)) && is_vertex(feature_of(mesh, t2, tip)));
  expect_planes(mesh, tip, {});
}

// Cases that Li et al. leave open: paper.h documents the decisions.

TEST(PaperRule, ACoplanarEdgeCountsAsConvexSoAFlatQuadHasNoGap) {
  const auto mesh = ridge(0.0);
  expect_planes(mesh, {0, 0, 0.1}, {{t1, Vec3(0, 0, 1)}});
}

TEST(PaperRule, OnTheRidgeItselfBothFacesSpeakSinceThereIsNoDirectionToTheTip) {
  const auto mesh = ridge(1.0);
  expect_planes(mesh, {0, 0, 0}, {{t1, mesh->normal(t1)}, {t2, mesh->normal(t2)}});
}

TEST(PaperRule, ABoundaryEdgeActivatesNothing) {
  const auto mesh = mesh_of(Surface{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}});
  expect_planes(mesh, {0.3, -0.01, 0.05}, {});
}

TEST(PaperRule, ANonManifoldEdgeIsReadAsABoundary) {
  const auto mesh = mesh_of(
      Surface{{Vec3(0, -2, 0), Vec3(0, 2, 0), Vec3(-2, 0, -1), Vec3(2, 0, -1), Vec3(0, 0, -2)},
              {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}});
  expect_planes(mesh, {0, 0, 1}, {});
}

TEST(PaperRule, BelowTheSurfaceEveryPlaneVanishes) {
  // A known weakness of the rule of Li et al.: it does not constrain a tool that is inside.
  const auto mesh = ridge(0.0);
  expect_planes(mesh, {1, 0, -0.5}, {});
}

TEST(PaperRule, AToolThatSlidesOnAFaceIsHeldAlthoughRoundingPutsItAHairBelow) {
  const auto mesh = ridge(0.0);
  PaperRule rule;
  const std::vector<HalfSpace> planes = planes_at(mesh, rule, {1, 0, -1e-13}, far_enough);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_EQ(planes[0].source, t2);
  EXPECT_DOUBLE_EQ(planes[0].offset, 1e-13) << "back up to the face";
}

/// Returns a closed fan of four triangles around the origin. The apexes on the x and y axes have
/// the given heights.
std::shared_ptr<const Mesh> fan(double at_x, double at_y) {
  return mesh_of(Surface{
      {Vec3(0, 0, 0), Vec3(2, 0, at_x), Vec3(0, 2, at_y), Vec3(-2, 0, at_x), Vec3(0, -2, at_y)},
      {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}});
}

TEST(PaperRuleAtAVertex, OverASummitOneTriangleSpeaksForAll) {
  const auto mesh = fan(-1, -1);
  const Vec3 tip(0.01, 0.02, 0.5);
  for (TriangleId t = 0; t < 4; ++t) ASSERT_EQ(feature_of(mesh, t, tip), Feature::vertex_0);
  expect_planes(mesh, tip, {{0, tip.normalized()}});
}

TEST(PaperRuleAtAVertex, ASummitWithValleysKeepsThePlaneOfTheRidge) {
  // Edges along x are valleys and edges along y are ridges. Each triangle has one of each, and
  // Condition 2 applies first.
  const auto mesh = fan(0.5, -4);
  const Vec3 tip(-0.2, 0, 1);
  PaperRule rule;
  const std::vector<HalfSpace> planes = planes_at(mesh, rule, tip, 3.0);
  ASSERT_FALSE(planes.empty());
  for (TriangleId t = 0; t < 4; ++t) {
    const ClosestPoint closest = closest_point(mesh->triangle(t), tip);
    if (!is_vertex(closest.feature)) continue;
    // Under either condition, the triangle must be behind one of the planes.
    bool behind = false;
    for (const HalfSpace& plane : planes) {
      bool all = true;
      for (const Vec3& corner : mesh->triangle(t)) {
        all &= plane.normal.dot(corner - tip) <= plane.offset + 1e-12;
      }
      behind |= all;
    }
    EXPECT_TRUE(behind) << "triangle " << t;
  }
}

TEST(PaperRuleAtAVertex, AValleyAtEitherEdgeKeepsTheFace) {
  // T1's closest point is its corner at an end of the valley; T2's closest point is elsewhere.
  const auto mesh = valley(0.5);
  const Vec3 tip = Vec3(1, -2.5, 0.25) + 0.3 * mesh->normal(t2);
  ASSERT_TRUE(is_vertex(feature_of(mesh, t1, tip)));
  ASSERT_NE(closest_point(mesh->triangle(t1), tip).offset,
            closest_point(mesh->triangle(t2), tip).offset);
  expect_planes(mesh, tip, {{t1, mesh->normal(t1)}});
}

TEST(PaperRule, TheMarginSetsEveryPlaneBack) {
  const auto mesh = ridge(0.5);
  PaperRule rule;
  for (const Vec3& tip : {Vec3(0, 0, 1), Vec3(1, 0, 0.5), Vec3(-1, 0.2, 0.4)}) {
    const auto near = planes_at(mesh, rule, tip, 3.0, 0.0);
    const auto far = planes_at(mesh, rule, tip, 3.0, 0.25);
    ASSERT_EQ(near.size(), far.size());
    ASSERT_FALSE(near.empty());
    for (std::size_t i = 0; i < near.size(); ++i) {
      EXPECT_EQ(near[i].normal, far[i].normal);
      EXPECT_DOUBLE_EQ(near[i].offset + 0.25, far[i].offset);
    }
  }
}

TEST(PaperRule, DoesNotDependOnHowTrianglesAreRotated) {
  Random random(7);
  const auto mesh = fan(0.5, -1);
  Surface rotated = surface_of(*mesh);
  for (Corners& c : rotated.triangles) c = {c[1], c[2], c[0]};
  const auto other = mesh_of(rotated);
  PaperRule rule, other_rule;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 tip = 2.0 * random.direction() * random.uniform();
    const auto expected = planes_at(mesh, rule, tip, 3.0);
    const auto got = planes_at(other, other_rule, tip, 3.0);
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t p = 0; p < got.size(); ++p) {
      ASSERT_EQ(got[p].normal, expected[p].normal);
      ASSERT_EQ(got[p].offset, expected[p].offset);
    }
  }
}

}  // namespace
}  // namespace keepout
