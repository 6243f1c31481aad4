// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/diagnostics.h"

#include <gtest/gtest.h>

#include "meshes.h"

namespace keepout {
namespace {

MeshFindings examine(const Surface& surface) { return keepout::examine(Mesh(surface)); }

/// Returns two tetrahedra that share only the vertex at the origin.
Surface pinched() {
  Surface mirrored = tetrahedron();
  for (Vec3& v : mirrored.vertices) v = -v;
  return weld(together(tetrahedron(), flipped(mirrored)));
}

TEST(Diagnostics, ATetrahedronIsWatertightAndWithoutFault) {
  const MeshFindings findings = examine(tetrahedron());
  EXPECT_EQ(findings.vertices, 4u);
  EXPECT_EQ(findings.triangles, 4u);
  EXPECT_EQ(findings.edges, 6u);
  EXPECT_EQ(findings.components, 1u);
  EXPECT_EQ(findings.edge_components, 1u);
  EXPECT_EQ(findings.boundary_edges, 0u);
  EXPECT_EQ(findings.non_manifold_edges, 0u);
  EXPECT_EQ(findings.inconsistent_edges, 0u);
  EXPECT_EQ(findings.pinched_vertices, 0u);
  EXPECT_EQ(findings.degenerate_triangles(), 0u);
  EXPECT_EQ(findings.duplicate_triangles, 0u);
  EXPECT_EQ(findings.unused_vertices, 0u);
  EXPECT_EQ(findings.euler_characteristic, 2);
  EXPECT_EQ(findings.genus, 0);
  EXPECT_TRUE(findings.is_closed());
  EXPECT_TRUE(findings.is_watertight());
  EXPECT_FALSE(findings.is_inside_out());
  EXPECT_DOUBLE_EQ(findings.signed_volume, 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(findings.area, 1.5 + std::numbers::sqrt3 / 2.0);
  EXPECT_EQ(findings.bounds.low, Vec3(0, 0, 0));
  EXPECT_EQ(findings.bounds.high, Vec3(1, 1, 1));
}

TEST(Diagnostics, AClosedMeshWithANegativeVolumeIsInsideOut) {
  const MeshFindings findings = examine(flipped(tetrahedron()));
  EXPECT_DOUBLE_EQ(findings.signed_volume, -1.0 / 6.0);
  EXPECT_TRUE(findings.is_watertight());
  EXPECT_TRUE(findings.is_inside_out());
}

TEST(Diagnostics, AnOpenMeshIsNeverInsideOut) {
  const MeshFindings findings = examine(opened(flipped(tetrahedron())));
  EXPECT_LT(findings.signed_volume, 0.0);
  EXPECT_FALSE(findings.is_inside_out());
}

TEST(Diagnostics, TheVolumeDoesNotSufferFromADistantOrigin) {
  const MeshFindings findings = examine(moved(tetrahedron(), {1e6, -1e6, 1e6}));
  EXPECT_NEAR(findings.signed_volume, 1.0 / 6.0, 1e-9);
}

TEST(Diagnostics, CountsHandles) {
  EXPECT_EQ(examine(torus(10)).genus, 1);
  EXPECT_EQ(examine(torus(10)).euler_characteristic, 0);
  const Surface two = together(torus(10), moved(torus(8), {20, 0, 0}));
  EXPECT_EQ(examine(two).genus, 2);
  EXPECT_EQ(examine(two).components, 2u);
  EXPECT_EQ(examine(together(tetrahedron(), moved(torus(8), {20, 0, 0}))).genus, 1);
}

TEST(Diagnostics, CountsEachBoundaryEdgeOnce) {
  EXPECT_EQ(examine(single_triangle()).boundary_edges, 3u);
  const MeshFindings findings = examine(opened(tetrahedron()));
  EXPECT_EQ(findings.boundary_edges, 3u);
  EXPECT_EQ(findings.edges, 6u);
  EXPECT_FALSE(findings.is_closed());
  EXPECT_FALSE(findings.is_watertight());
  EXPECT_EQ(findings.genus, std::nullopt);
}

TEST(Diagnostics, CountsEachNonManifoldEdgeOnce) {
  Surface fin = tetrahedron();
  fin.vertices.emplace_back(2, 2, 0);
  fin.triangles.push_back({1, 2, 4});
  const MeshFindings findings = examine(fin);
  EXPECT_EQ(findings.non_manifold_edges, 1u);
  EXPECT_EQ(findings.boundary_edges, 2u);
  EXPECT_EQ(findings.inconsistent_edges, 0u);
  EXPECT_FALSE(findings.is_watertight());
}

TEST(Diagnostics, ClosedWithANonManifoldEdgeIsClosedButNotWatertight) {
  // Two tetrahedra share one edge, which thus has four triangles.
  Surface other = tetrahedron();
  for (Vec3& v : other.vertices) v = Vec3(-v.x(), -v.y(), v.z());
  const MeshFindings findings = examine(weld(together(tetrahedron(), other)));
  EXPECT_EQ(findings.vertices, 6u);
  EXPECT_EQ(findings.non_manifold_edges, 1u);
  EXPECT_TRUE(findings.is_closed());
  EXPECT_FALSE(findings.is_watertight());
  EXPECT_EQ(findings.genus, std::nullopt);
}

TEST(Diagnostics, CountsInconsistentlyWoundEdges) {
  Surface surface = tetrahedron();
  std::swap(surface.triangles[0][0], surface.triangles[0][1]);
  const MeshFindings findings = examine(surface);
  EXPECT_EQ(findings.inconsistent_edges, 3u);
  EXPECT_TRUE(findings.is_closed());
  EXPECT_FALSE(findings.is_watertight());
  EXPECT_EQ(findings.genus, std::nullopt);
}

TEST(Diagnostics, APinchedVertexJoinsComponentsButNotPatches) {
  const MeshFindings findings = examine(pinched());
  EXPECT_EQ(findings.vertices, 7u);
  EXPECT_EQ(findings.pinched_vertices, 1u);
  EXPECT_EQ(findings.components, 1u);
  EXPECT_EQ(findings.edge_components, 2u);
  EXPECT_TRUE(findings.is_watertight());
  EXPECT_EQ(findings.genus, std::nullopt);
}

TEST(Diagnostics, TellsTrianglesThatNameAVertexTwiceFromCollinearOnes) {
  Surface surface = single_triangle();
  surface.vertices.emplace_back(3, 0, 0);
  surface.triangles.push_back({0, 1, 1});
  surface.triangles.push_back({2, 2, 2});
  surface.triangles.push_back({0, 1, 3});
  const MeshFindings findings = examine(surface);
  EXPECT_EQ(findings.repeated_vertex_triangles, 2u);
  EXPECT_EQ(findings.collinear_triangles, 1u);
  EXPECT_EQ(findings.degenerate_triangles(), 3u);
}

TEST(Diagnostics, ATriangleThatNamesAVertexTwiceDoesNotOpenOrJoinAnything) {
  Surface surface = together(tetrahedron(), moved(tetrahedron(), {5, 0, 0}));
  surface.triangles.push_back({1, 2, 1});
  surface.triangles.push_back({3, 4, 4});  // connects both
  const MeshFindings findings = examine(surface);
  EXPECT_EQ(findings.edges, 12u);
  EXPECT_EQ(findings.components, 2u);
  EXPECT_EQ(findings.edge_components, 2u);
  EXPECT_TRUE(findings.is_watertight());
  EXPECT_EQ(findings.genus, 0);
}

TEST(Diagnostics, CollinearMeansExactlySo) {
  // The two middle points are neighboring doubles; only the first is exactly on the line.
  const double third = 1.0 / 3.0;
  const Surface on_line{{{0, 0, 0}, {third, third, third}, {1, 1, 1}}, {{0, 1, 2}}};
  Surface off_line = on_line;
  off_line.vertices[1].z() = std::nextafter(third, 1.0);
  EXPECT_EQ(examine(on_line).collinear_triangles, 1u);
  EXPECT_EQ(examine(off_line).collinear_triangles, 0u);
}

TEST(Diagnostics, CountsDuplicatesWhateverTheirWindingAndFirstCorner) {
  Surface surface = tetrahedron();
  surface.triangles.push_back({2, 1, 0});  // the first triangle, with another first corner
  surface.triangles.push_back({1, 2, 0});  // and flipped
  surface.triangles.push_back({3, 2, 1});
  EXPECT_EQ(examine(surface).duplicate_triangles, 3u);
}

TEST(Diagnostics, CountsVerticesThatNoTriangleUses) {
  Surface surface = tetrahedron();
  surface.vertices.emplace_back(7, 7, 7);
  const MeshFindings findings = examine(surface);
  EXPECT_EQ(findings.vertices, 4u);
  EXPECT_EQ(findings.unused_vertices, 1u);
  EXPECT_EQ(findings.components, 1u);
  EXPECT_EQ(findings.genus, 0);
}

TEST(Diagnostics, WhatIsSmallInEveryDirectionLooksLikeMetres) {
  EXPECT_TRUE(examine(tetrahedron()).looks_like_meters());
  Surface long_one = tetrahedron();
  long_one.vertices[3].z() = 180.0;
  EXPECT_FALSE(examine(long_one).looks_like_meters());
}

TEST(Diagnostics, FindsTheSameInAnyOrderOfTriangles) {
  Surface surface = together(torus(9), moved(pinched(), {0, 0, 9}));
  surface.triangles.erase(surface.triangles.begin() + 20, surface.triangles.begin() + 24);
  std::swap(surface.triangles[60][0], surface.triangles[60][1]);
  surface.triangles.push_back(surface.triangles[3]);
  const MeshFindings given = examine(surface);
  EXPECT_GT(given.boundary_edges, 0u);
  for (const unsigned seed : {1u, 2u, 3u}) {
    const MeshFindings other = examine(shuffled(surface, seed));
    EXPECT_EQ(other.edges, given.edges);
    EXPECT_EQ(other.boundary_edges, given.boundary_edges);
    EXPECT_EQ(other.non_manifold_edges, given.non_manifold_edges);
    EXPECT_EQ(other.inconsistent_edges, given.inconsistent_edges);
    EXPECT_EQ(other.pinched_vertices, given.pinched_vertices);
    EXPECT_EQ(other.duplicate_triangles, given.duplicate_triangles);
    EXPECT_EQ(other.components, given.components);
    EXPECT_EQ(other.edge_components, given.edge_components);
    EXPECT_EQ(other.euler_characteristic, given.euler_characteristic);
    EXPECT_NEAR(other.area, given.area, 1e-12 * given.area);
  }
}

/// Returns the centers of faults.
std::vector<Vec3> middles(const FaultPlaces& faults) {
  std::vector<Vec3> all;
  for (const FaultPlace& place : faults.places) all.push_back(place.at);
  return all;
}

TEST(Diagnostics, FaultsAreWhereTheyWereMade) {
  Surface surface = tetrahedron();
  std::swap(surface.triangles[3][0], surface.triangles[3][1]);
  const FaultPlaces seams = examine(surface).places.inconsistent_edges;
  EXPECT_EQ(seams.groups, 1u);
  EXPECT_EQ(middles(seams), (std::vector<Vec3>{{0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}));
  EXPECT_EQ(seams.places[0].corners, (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}}));

  surface = tetrahedron();
  surface.triangles.push_back({1, 1, 2});
  surface.triangles.push_back({3, 2, 1});
  const MeshFaultPlaces places = examine(surface).places;
  EXPECT_EQ(places.degenerate_triangles.places.at(0).corners,
            (std::vector<Vec3>{{1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_TRUE(places.duplicate_triangles.places.at(0).at.isApprox(Vec3::Constant(1.0 / 3.0)));
  EXPECT_EQ(places.non_manifold_edges.groups, 1u);
  EXPECT_EQ(places.non_manifold_edges.places.size(), 3u);

  EXPECT_EQ(middles(examine(pinched()).places.pinched_vertices), std::vector<Vec3>{Vec3::Zero()});
}

TEST(Diagnostics, OnePlaceOfEachHoleComesFirst) {
  const Surface open = opened(tetrahedron());
  const Surface two = together(open, moved(open, {10, 0, 0}));
  const FaultPlaces holes = keepout::examine(Mesh(two), 2).places.boundary_edges;
  EXPECT_EQ(holes.groups, 2u);
  EXPECT_EQ(middles(holes), (std::vector<Vec3>{{0.5, 0.5, 0}, {10.5, 0.5, 0}}));
  EXPECT_EQ(keepout::examine(Mesh(two), 5).places.boundary_edges.places.size(), 5u);
  EXPECT_EQ(keepout::examine(Mesh(two), 0).boundary_edges, 6u);
  EXPECT_TRUE(keepout::examine(Mesh(two), 0).places.boundary_edges.places.empty());
}

}  // namespace
}  // namespace keepout
