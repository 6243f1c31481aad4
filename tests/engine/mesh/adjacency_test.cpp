// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/adjacency.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "meshes.h"

namespace keepout {
namespace {

/// Returns two triangles that share the edge from the origin along y. The second apex is `height`
/// above the plane of the first, whose normal is along z.
Surface pair_with_apex(double height) {
  return {{{0, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {1, 0.5, height}}, {{0, 1, 2}, {1, 0, 3}}};
}

/// Returns the number of the edge of t between the vertices a and b, in either direction.
int edge_between(const Mesh& mesh, TriangleId t, VertexId a, VertexId b) {
  for (int e = 0; e < 3; ++e) {
    const VertexId from = mesh.corners(t)[e];
    const VertexId to = mesh.corners(t)[(e + 1) % 3];
    if ((from == a && to == b) || (from == b && to == a)) return e;
  }
  ADD_FAILURE() << "triangle " << t << " has no edge " << a << " " << b;
  return 0;
}

EdgeKind kind_of_pair(const Surface& surface) {
  const Mesh mesh(surface);
  const Adjacency adjacency(mesh);
  EXPECT_EQ(adjacency.neighbor(0, edge_between(mesh, 0, 0, 1)), 1u);
  EXPECT_EQ(adjacency.neighbor(1, edge_between(mesh, 1, 0, 1)), 0u);
  const EdgeKind kind = adjacency.kind(0, edge_between(mesh, 0, 0, 1));
  EXPECT_EQ(adjacency.kind(1, edge_between(mesh, 1, 0, 1)), kind);
  return kind;
}

TEST(Adjacency, ARidgeIsConvexAndAValleyConcave) {
  EXPECT_EQ(kind_of_pair(pair_with_apex(-0.5)), EdgeKind::convex);
  EXPECT_EQ(kind_of_pair(pair_with_apex(0.5)), EdgeKind::concave);
}

TEST(Adjacency, TheOtherSideOfARidgeIsAValley) {
  EXPECT_EQ(kind_of_pair(flipped(pair_with_apex(-0.5))), EdgeKind::concave);
  EXPECT_EQ(kind_of_pair(flipped(pair_with_apex(0.5))), EdgeKind::convex);
}

TEST(Adjacency, FlatAndBendsBelowRoundingAreCoplanar) {
  EXPECT_EQ(kind_of_pair(pair_with_apex(0.0)), EdgeKind::coplanar);
  EXPECT_EQ(kind_of_pair(pair_with_apex(1e-13)), EdgeKind::coplanar);
  EXPECT_EQ(kind_of_pair(pair_with_apex(-1e-13)), EdgeKind::coplanar);
  EXPECT_EQ(kind_of_pair(pair_with_apex(1e-9)), EdgeKind::concave);
  EXPECT_EQ(kind_of_pair(pair_with_apex(-1e-9)), EdgeKind::convex);
}

TEST(Adjacency, FoldedBackByHalfATurnIsCoplanar) {
  Surface folded = pair_with_apex(0.0);
  folded.vertices[3].x() = -2.0;
  EXPECT_EQ(kind_of_pair(folded), EdgeKind::coplanar);
}

TEST(Adjacency, WindingsThatContradictEachOtherAreInconsistent) {
  Surface contradictory = pair_with_apex(0.5);
  contradictory.triangles[1] = {0, 1, 3};
  EXPECT_EQ(kind_of_pair(contradictory), EdgeKind::inconsistent);
}

TEST(Adjacency, AnEdgeOfOneTriangleIsABoundaryWithoutANeighbour) {
  const Mesh mesh(single_triangle());
  const Adjacency adjacency(mesh);
  for (int e = 0; e < 3; ++e) {
    EXPECT_EQ(adjacency.kind(0, e), EdgeKind::boundary);
    EXPECT_EQ(adjacency.neighbor(0, e), no_triangle);
  }
}

TEST(Adjacency, AnEdgeOfThreeTrianglesIsNonManifoldWithoutANeighbour) {
  Surface fin = pair_with_apex(0.5);
  fin.vertices.emplace_back(0, 0.5, 1);
  fin.triangles.push_back({0, 1, 4});
  const Mesh mesh(fin);
  const Adjacency adjacency(mesh);
  for (TriangleId t = 0; t < 3; ++t) {
    const int e = edge_between(mesh, t, 0, 1);
    EXPECT_EQ(adjacency.kind(t, e), EdgeKind::non_manifold) << t;
    EXPECT_EQ(adjacency.neighbor(t, e), no_triangle) << t;
  }
}

TEST(Adjacency, ATriangleThatNamesAVertexTwiceIsNoNeighbour) {
  Surface surface = pair_with_apex(-0.5);
  surface.triangles.push_back({0, 1, 1});
  EXPECT_EQ(kind_of_pair(surface), EdgeKind::convex);
  const Mesh mesh(surface);
  const Adjacency adjacency(mesh);
  for (int e = 0; e < 3; ++e) EXPECT_EQ(adjacency.neighbor(2, e), no_triangle);
}

TEST(Adjacency, AllEdgesOfATetrahedronAreRidgesFromOutsideAndValleysFromInside) {
  const Mesh outside(tetrahedron());
  const Mesh inside(flipped(tetrahedron()));
  const Adjacency from_outside(outside);
  const Adjacency from_inside(inside);
  for (TriangleId t = 0; t < 4; ++t) {
    std::set<TriangleId> neighbors;
    for (int e = 0; e < 3; ++e) {
      EXPECT_EQ(from_outside.kind(t, e), EdgeKind::convex);
      EXPECT_EQ(from_inside.kind(t, e), EdgeKind::concave);
      neighbors.insert(from_outside.neighbor(t, e));
    }
    neighbors.insert(t);
    EXPECT_EQ(neighbors, (std::set<TriangleId>{0, 1, 2, 3}));
  }
}

/// Returns a torus with holes, a fin and flipped triangles.
Surface mixed() {
  Surface surface = torus(12);
  std::swap(surface.triangles[40][1], surface.triangles[40][2]);
  std::swap(surface.triangles[41][0], surface.triangles[41][2]);
  surface.triangles.erase(surface.triangles.begin() + 100, surface.triangles.begin() + 105);
  surface.vertices.emplace_back(9, 9, 9);
  const auto apex = static_cast<VertexId>(surface.vertices.size() - 1);
  surface.triangles.push_back({surface.triangles[7][0], surface.triangles[7][1], apex});
  surface.triangles.push_back(surface.triangles[7]);
  return surface;
}

TEST(Adjacency, AgreesWithAnIndependentRecount) {
  const Mesh mesh(mixed());
  const Adjacency adjacency(mesh);
  std::map<std::pair<VertexId, VertexId>, std::vector<TriangleId>> by_edge;
  const auto ends = [&](TriangleId t, int e) {
    return std::pair(mesh.corners(t)[e], mesh.corners(t)[(e + 1) % 3]);
  };
  const auto sorted_ends = [&](TriangleId t, int e) {
    const auto [a, b] = ends(t, e);
    return std::pair(std::min(a, b), std::max(a, b));
  };
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    for (int e = 0; e < 3; ++e) by_edge[sorted_ends(t, e)].push_back(t);
  }
  std::map<EdgeKind, int> seen;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const std::vector<TriangleId>& triangles = by_edge[sorted_ends(t, e)];
      const EdgeKind kind = adjacency.kind(t, e);
      ++seen[kind];
      if (triangles.size() != 2) {
        ASSERT_EQ(kind, triangles.size() == 1 ? EdgeKind::boundary : EdgeKind::non_manifold);
        ASSERT_EQ(adjacency.neighbor(t, e), no_triangle);
        continue;
      }
      const TriangleId other = triangles[0] == t ? triangles[1] : triangles[0];
      ASSERT_EQ(adjacency.neighbor(t, e), other);
      const int back = edge_between(mesh, other, ends(t, e).first, ends(t, e).second);
      if (ends(t, e) == ends(other, back)) {
        ASSERT_EQ(kind, EdgeKind::inconsistent);
        continue;
      }
      // The apex of the neighbor is below the plane of t at a ridge, and above it at a valley.
      const Vec3 apex = mesh.vertex(mesh.corners(other)[(back + 2) % 3]);
      const double height = mesh.normal(t).dot(apex - mesh.triangle(t)[0]);
      ASSERT_EQ(kind, height < -1e-9  ? EdgeKind::convex
                      : height > 1e-9 ? EdgeKind::concave
                                      : EdgeKind::coplanar);
    }
  }
  EXPECT_GT(seen[EdgeKind::convex], 0);
  EXPECT_GT(seen[EdgeKind::concave], 0);
  EXPECT_GT(seen[EdgeKind::boundary], 0);
  EXPECT_GT(seen[EdgeKind::non_manifold], 0);
  EXPECT_GT(seen[EdgeKind::inconsistent], 0);
}

TEST(Adjacency, DoesNotDependOnTheOrderOfTrianglesOrCorners) {
  const Surface surface = mixed();
  const Mesh mesh(surface);
  const Adjacency adjacency(mesh);
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::vector<TriangleId> new_ids;
    const Mesh other(shuffled(surface, seed, &new_ids));
    const Adjacency shuffled_adjacency(other);
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      for (int e = 0; e < 3; ++e) {
        const int f =
            edge_between(other, new_ids[t], mesh.corners(t)[e], mesh.corners(t)[(e + 1) % 3]);
        ASSERT_EQ(adjacency.kind(t, e), shuffled_adjacency.kind(new_ids[t], f));
        const TriangleId neighbor = adjacency.neighbor(t, e);
        ASSERT_EQ(neighbor == no_triangle ? no_triangle : new_ids[neighbor],
                  shuffled_adjacency.neighbor(new_ids[t], f));
      }
    }
  }
}

TEST(Bend, IsTheSameFromBothSidesToTheLastBit) {
  // Angles around the tolerance of 1e-12 rad, where rounding decides.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> height(-2e-12, 2e-12);
  int flat = 0;
  for (int i = 0; i < 2000; ++i) {
    const Mesh mesh(pair_with_apex(height(random)));
    const EdgeKind forth = bend(mesh.triangle(0), 0, mesh.triangle(1), 0);
    const EdgeKind back = bend(mesh.triangle(1), 0, mesh.triangle(0), 0);
    ASSERT_EQ(forth, back) << i;
    flat += forth == EdgeKind::coplanar ? 1 : 0;
  }
  EXPECT_GT(flat, 0);
  EXPECT_LT(flat, 2000);
}

}  // namespace
}  // namespace keepout
