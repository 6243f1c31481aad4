// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/repair.h"

#include "meshes.h"

namespace keepout {
namespace {

TEST(RemoveFaultyTriangles, SegmentsAndDuplicatesGo) {
  Surface surface = tetrahedron();
  surface.triangles.push_back({1, 1, 2});
  surface.triangles.push_back(surface.triangles[0]);
  surface.triangles.push_back(
      {surface.triangles[1][1], surface.triangles[1][0], surface.triangles[1][2]});
  surface.vertices.emplace_back(9, 9, 9);  // unused
  const RemovedTriangles removed = remove_faulty_triangles(surface);
  EXPECT_EQ(removed.degenerate, 1u);
  EXPECT_EQ(removed.duplicates, 2u);
  EXPECT_EQ(removed.opposite_duplicates, 1u);
  EXPECT_EQ(removed.collinear_left, 0u);
  EXPECT_EQ(surface.triangles, weld(tetrahedron()).triangles);
  EXPECT_EQ(surface.vertices.size(), 4u);
}

TEST(RemoveFaultyTriangles, ATriangleOnALineStaysOnlyIfNeighborsWouldGape) {
  Surface lone = tetrahedron();
  lone.vertices.insert(lone.vertices.end(), {{5, 0, 0}, {6, 0, 0}, {8, 0, 0}});
  lone.triangles.push_back({4, 5, 6});
  RemovedTriangles removed = remove_faulty_triangles(lone);
  EXPECT_EQ(removed.degenerate, 1u);
  EXPECT_EQ(lone.triangles.size(), 4u);

  // A square of four triangles, of which one lies on the diagonal and has no area.
  Surface joined{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                 {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}}};
  removed = remove_faulty_triangles(joined);
  EXPECT_EQ(removed.degenerate, 0u);
  EXPECT_EQ(removed.collinear_left, 1u);
  EXPECT_EQ(joined.triangles.size(), 4u);
}

TEST(RemoveFaultyTriangles, NothingMayBeLeft) {
  Surface surface{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}}};
  EXPECT_EQ(remove_faulty_triangles(surface).degenerate, 2u);
  EXPECT_TRUE(surface.triangles.empty());
}

}  // namespace
}  // namespace keepout
