// SPDX-License-Identifier: BSD-3-Clause
// Sides of a surface, and passages through it. Closed surfaces: tests/oracle/inside_test_test.cpp.
#include "simulate/audit.h"

#include <Eigen/Geometry>

#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::app {
namespace {

TEST(Audit, ClearanceIsSignedOnAClosedMesh) {
  Audit audit(mesh_of(make_cube(10.0)));
  EXPECT_EQ(audit.surface(), SurfaceKind::closed);
  EXPECT_NEAR(audit.clearance({0, 0, 53}), 3.0, 1e-12);
  EXPECT_NEAR(audit.clearance({0, 0, 48}), -2.0, 1e-12);
  EXPECT_EQ(audit.clearance({1, 2, 50.0 - 1e-9}), 0.0) << "touching is not inside";
  EXPECT_NEAR(audit.clearance({1, 2, 50.0 - 1e-5}), -1e-5, 1e-12);
}

TEST(Audit, OfAMeshWoundInwardsTheOutsideIsForbidden) {
  Audit audit(mesh_of(make_concave_sphere(3.0)));
  EXPECT_GT(audit.clearance({0, 0, 10}), 0.0);
  EXPECT_LT(audit.clearance({0, 0, 60}), 0.0);
}

TEST(Audit, TellsTheSidesOfASurface) {
  Audit closed(mesh_of(make_cube(10.0)));
  EXPECT_EQ(closed.side({1, 2, 51}), Side::front);
  EXPECT_EQ(closed.side({1, 2, 49}), Side::behind);
  EXPECT_EQ(closed.side({1, 2, 50 + 1e-9}), Side::touching);
  Audit open(mesh_of(make_flat_plate(5.0, 1)));  // at z = 0, 100 x 100
  EXPECT_EQ(open.surface(), SurfaceKind::open);
  EXPECT_EQ(open.side({3, 4, 0.2}), Side::front);
  EXPECT_EQ(open.side({3, 4, -0.2}), Side::behind);
  EXPECT_NEAR(open.clearance({3, 4, -2.0}), 2.0, 1e-12) << "unsigned where there is no inside";
}

TEST(Audit, FindsTheNearestTriangleThatAnIndexFinds) {
  Random random(4);
  for (const char* name : {"cortex", "saddle_terrain", "far_cube", "needles"}) {
    const auto mesh = mesh_of(make_shape(name));
    const PdTree index(mesh);
    NearestTriangle expected(*mesh, index);
    Audit audit(mesh);
    std::vector<Vec3> points = random_points(*mesh, 100, random);
    // Several triangles are equally near to a vertex.
    for (VertexId v = 0; v < 100; ++v) points.push_back(mesh->vertex(v));
    for (const Vec3& point : points) {
      const Hit found = audit.nearest(point);
      const Hit other = expected(point);
      ASSERT_EQ(found.triangle, other.triangle) << name << " at " << point.transpose();
      ASSERT_EQ(found.closest.offset, other.closest.offset);
    }
  }
}

/// Returns how often a tip that moves straight from each point to the next passes through the mesh.
std::size_t passages(const std::shared_ptr<const Mesh>& mesh, const std::vector<Vec3>& way) {
  Audit audit(mesh);
  PathAudit path(audit, way.front());
  std::size_t count = 0;
  for (const Vec3& point : way) count += path.follow(point);
  return count;
}

/// Returns the same for a tip that moves along one vertical line.
std::size_t passages(const std::shared_ptr<const Mesh>& mesh, const std::vector<double>& heights) {
  std::vector<Vec3> way;
  for (const double z : heights) way.emplace_back(1.3, 2.1, z);
  return passages(mesh, way);
}

TEST(PathAudit, CountsAPassageThroughAnOpenSheetAlsoWhenItTouchesFirst) {
  const auto plate = mesh_of(make_flat_plate(5.0, 1));
  EXPECT_EQ(passages(plate, {1.0, -1.0}), 1u);
  EXPECT_EQ(passages(plate, {-1.0, 1.0}), 1u);
  EXPECT_EQ(passages(plate, {1.0, 0.0, -1.0}), 1u);
  EXPECT_EQ(passages(plate, {1.0, -1e-7, -1.0}), 1u);
  EXPECT_EQ(passages(plate, {1.0, -5e-7, -2e-6, -1.0}), 1u);
  EXPECT_EQ(passages(plate, {1.0, 0.0, -1.0, 0.0, 1.0}), 2u);
  EXPECT_EQ(passages(plate, {1.0, 0.0, 1.0}), 0u);
  EXPECT_EQ(passages(plate, {1.0, 0.0, -1e-12, 1e-12, 0.5}), 0u) << "the noise of a contact";
}

TEST(PathAudit, SeesAPassageThroughAThinPlateWithinOneMove) {
  const auto plates = mesh_of(make_shape("thin_plates"));  // 1 thick, with gaps of 1
  const double top = plates->bounds().high.z();
  EXPECT_EQ(passages(plates, {top + 0.3, top - 1.3}), 1u) << "through, into the gap";
  EXPECT_EQ(passages(plates, {top + 0.3, top, top - 1.3}), 1u) << "the same, touching first";
  EXPECT_EQ(passages(plates, {top + 0.3, top - 1e-13, top - 1.3}), 1u);
  EXPECT_EQ(passages(plates, {top + 0.3, top - 0.3}), 1u) << "in";
  EXPECT_EQ(passages(plates, {top + 0.3, top - 0.3, top + 0.3}), 2u) << "in and out";
  EXPECT_EQ(passages(plates, {top + 0.3, top + 0.1, top}), 0u) << "to touch is not to cross";
}

TEST(PathAudit, SeesAPassageThroughTwoOpenSheetsWithinOneMove) {
  // The sheets face away from each other, so the space in front of each one is outside.
  const auto sheets =
      mesh_of({{Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(9, 9, 0), Vec3(0, 9, 0), Vec3(0, 0, -0.2),
                Vec3(9, 0, -0.2), Vec3(9, 9, -0.2), Vec3(0, 9, -0.2)},
               {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}}});
  EXPECT_EQ(passages(sheets, {1.0, -1.0}), 1u);
  EXPECT_EQ(passages(sheets, {1.0, -0.1, -1.0}), 2u);
}

TEST(PathAudit, SlidingInContactOverRidgesIsNoPassage) {
  const auto box = mesh_of(make_cube(10.0));
  const auto slides = [&](const Vec3& from, const Vec3& to) {
    return passages(box, std::vector<Vec3>{from, to, to + Vec3(1, 0, 1)});
  };
  EXPECT_EQ(slides({49.9, 0, 50}, {50.3, 0, 50}), 0u);
  EXPECT_EQ(slides({49.9, 0, 50 - 1e-13}, {50.3, 0, 50 - 1e-13}), 0u);
  EXPECT_EQ(slides({50, 0, 49.8}, {50, 0, 50.2}), 0u);
}

TEST(PathAudit, ARimMayBeWalkedAround) {
  const auto plate = mesh_of(make_flat_plate(5.0, 1));
  EXPECT_EQ(
      passages(plate, std::vector<Vec3>{{40, 4, 0.5}, {51, 4, 0.5}, {51, 4, -0.5}, {40, 4, -0.5}}),
      0u);
}

TEST(PathAudit, AgreesWithTheHeightOfATerrainAlongARandomWalk) {
  const auto terrain = mesh_of(make_shape("saddle_terrain"));
  Audit audit(terrain);
  // Finds the side by the height of the triangle above or below, and shares no code with the audit.
  const auto is_below = [&](const Vec3& point) {
    for (TriangleId t = 0; t < terrain->triangle_count(); ++t) {
      const Triangle c = terrain->triangle(t);
      const auto area = [&](const Vec3& a, const Vec3& b) {
        return (a.x() - point.x()) * (b.y() - point.y()) -
               (b.x() - point.x()) * (a.y() - point.y());
      };
      const double u = area(c[1], c[2]), v = area(c[2], c[0]), w = area(c[0], c[1]);
      if (u < 0.0 || v < 0.0 || w < 0.0) continue;
      return point.z() < (u * c[0].z() + v * c[1].z() + w * c[2].z()) / (u + v + w);
    }
    ADD_FAILURE() << "beyond the terrain";
    return false;
  };
  Random random(3);
  Vec3 tip(0, 0, 20);
  PathAudit path(audit, tip);
  bool below = is_below(tip);
  std::size_t changes = 0;
  for (int i = 0; i < test::trials(1000); ++i) {
    const Vec3 to = (0.98 * tip + 1.5 * random.direction()).eval();
    // Over a crest, a move may enter and leave the terrain.
    bool changes_side = false;
    for (int share = 1; share <= 100; ++share) {
      changes_side |= is_below(tip + 0.01 * share * (to - tip)) != below;
    }
    ASSERT_EQ(path.follow(to), changes_side) << "move " << i;
    changes += changes_side;
    below = is_below(to);
    tip = to;
  }
  EXPECT_GT(changes, test::trials(20u));
}

}  // namespace
}  // namespace keepout::app
