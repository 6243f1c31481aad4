// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/self_intersection.h"

#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "meshes.h"
#include "trials.h"

namespace keepout {
namespace {

/// Returns true if the two triangles of the surface meet. The answer must be the same for either
/// order, for each winding and first corner, and after a linear map.
bool meet(const Surface& given) {
  EXPECT_EQ(given.triangles.size(), 2u);
  const bool first_answer = meet_improperly(Mesh(given), 0, 1);
  for (int permutation = 0; permutation < 72; ++permutation) {
    Surface surface = given;
    for (int t = 0; t < 2; ++t) {
      Corners& c = surface.triangles[t];
      std::rotate(c.begin(), c.begin() + (t == 0 ? permutation : permutation / 3) % 3, c.end());
      if ((permutation / 9) % 2 == 1 && t == 0) std::swap(c[0], c[1]);
      if ((permutation / 18) % 2 == 1 && t == 1) std::swap(c[0], c[1]);
    }
    for (Vec3& v : surface.vertices) {  // exact for integers and halves
      if (permutation / 36 == 1) v = Vec3(v.z(), v.x() + 4 * v.y(), v.y());
    }
    const Mesh mesh(surface);
    EXPECT_EQ(meet_improperly(mesh, 0, 1), first_answer) << permutation;
    EXPECT_EQ(meet_improperly(mesh, 1, 0), first_answer) << permutation;
  }
  return first_answer;
}

/// Returns the triangle (0, 0), (4, 0), (0, 4) in the plane z = 0, and one of three more points.
Surface beside_base(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b, c}, {{0, 1, 2}, {3, 4, 5}}};
}

/// Like beside_base, but the second triangle starts at the base's corner at the origin.
Surface at_base_corner(const Vec3& b, const Vec3& c) {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, b, c}, {{0, 1, 2}, {0, 3, 4}}};
}

/// Like beside_base, but the second triangle shares the base's edge along x.
Surface on_base_edge(const Vec3& apex) {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, apex}, {{0, 1, 2}, {1, 0, 3}}};
}

TEST(MeetImproperly, TrianglesApartDoNot) {
  EXPECT_FALSE(meet(beside_base({0, 0, 1}, {4, 0, 1}, {0, 4, 1})));
  EXPECT_FALSE(meet(beside_base({5, 0, -1}, {5, 0, 1}, {9, 0, 0})));
  EXPECT_FALSE(meet(beside_base({3, 3, -1}, {3, 3, 1}, {4, 4, 0})));  // crosses z = 0 off the base
}

TEST(MeetImproperly, TrianglesThatCutThroughEachOtherDo) {
  EXPECT_TRUE(meet(beside_base({1, 1, -1}, {1, 1, 1}, {9, 9, 0})));
  EXPECT_TRUE(meet(beside_base({1, 1, -1}, {2, 1, -1}, {1, 1, 1})));
  EXPECT_TRUE(meet(beside_base({1, 1, -1}, {9, 9, -1}, {-9, -9, 9})));
}

TEST(MeetImproperly, TouchingIsMeeting) {
  EXPECT_TRUE(meet(beside_base({1, 1, 0}, {1, 1, 5}, {2, 1, 5})));    // a vertex on the face
  EXPECT_TRUE(meet(beside_base({2, 0, 0}, {2, 0, 5}, {3, 0, 5})));    // a vertex on an edge
  EXPECT_TRUE(meet(beside_base({2, -1, 1}, {2, 1, -1}, {9, 0, 9})));  // two edges
  EXPECT_TRUE(meet(beside_base({1, 1, 0}, {2, 1, 0}, {1, 1, 5})));    // an edge on the face
  EXPECT_FALSE(meet(beside_base({1, 1, 0.5}, {1, 1, 5}, {2, 1, 5})));
}

TEST(MeetImproperly, InOnePlaneOverlapCountsAndSoDoesContainment) {
  EXPECT_TRUE(meet(beside_base({1, 1, 0}, {9, 1, 0}, {9, 9, 0})));
  EXPECT_TRUE(meet(beside_base({1, 1, 0}, {2, 1, 0}, {1, 2, 0})));
  EXPECT_TRUE(meet(beside_base({-9, -9, 0}, {40, -9, 0}, {-9, 40, 0})));
  EXPECT_TRUE(meet(beside_base({2, 2, 0}, {5, 2, 0}, {5, 5, 0})));  // a corner on an edge
  EXPECT_FALSE(meet(beside_base({5, 0, 0}, {9, 0, 0}, {5, 4, 0})));
  EXPECT_FALSE(meet(beside_base({3, 2, 0}, {5, 2, 0}, {5, 5, 0})));
}

TEST(MeetImproperly, ACommonCornerAloneDoesNotCount) {
  EXPECT_FALSE(meet(at_base_corner({-1, 0, 2}, {0, -1, 2})));
  EXPECT_FALSE(meet(at_base_corner({1, 1, 2}, {2, 1, 2})));    // above the base
  EXPECT_FALSE(meet(at_base_corner({-1, 0, 0}, {0, -1, 0})));  // in its plane
}

TEST(MeetImproperly, BeyondACommonCornerItDoes) {
  EXPECT_TRUE(meet(at_base_corner({1, 1, -1}, {1, 1, 1})));  // cuts through
  EXPECT_TRUE(meet(at_base_corner({9, 9, -1}, {9, 9, 1})));  // and extends beyond the base
  EXPECT_TRUE(meet(at_base_corner({1, 1, 0}, {1, 1, 3})));   // an edge lies on the base
  EXPECT_TRUE(meet(at_base_corner({2, 0, 0}, {2, -1, 3})));  // or on its edge
  EXPECT_TRUE(meet(at_base_corner({1, 2, 0}, {-3, 1, 0})));  // overlaps in its plane
}

TEST(MeetImproperly, ACommonEdgeCountsOnlyWhenFoldedFlat) {
  EXPECT_FALSE(meet(on_base_edge({1, -3, 0})));  // spread flat
  EXPECT_FALSE(meet(on_base_edge({1, 3, 1})));   // nearly folded
  EXPECT_TRUE(meet(on_base_edge({1, 3, 0})));    // folded
}

TEST(MeetImproperly, ADuplicateDoes) {
  EXPECT_TRUE(meet({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {1, 2, 0}}}));
}

TEST(MeetImproperly, ATriangleWithoutAnAreaDoesNot) {
  EXPECT_FALSE(meet(beside_base({1, 1, -1}, {1, 1, 0}, {1, 1, 1})));
  EXPECT_FALSE(meet({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}}, {{0, 1, 2}, {3, 3, 0}}}));
}

std::size_t count(const Surface& surface) {
  const auto mesh = mesh_of(surface);
  const std::size_t pairs = count_self_intersections(*mesh, PdTree(mesh));
  std::size_t all_pairs = 0;
  for (TriangleId a = 0; a < mesh->triangle_count(); ++a) {
    for (TriangleId b = a + 1; b < mesh->triangle_count(); ++b) {
      all_pairs += meet_improperly(*mesh, a, b) ? 1 : 0;
    }
  }
  EXPECT_EQ(pairs, all_pairs);
  EXPECT_EQ(count_self_intersections(*mesh, BruteForce(mesh)), all_pairs);
  return pairs;
}

TEST(SelfIntersections, OfSimpleSurfacesThereAreNone) {
  EXPECT_EQ(count(tetrahedron()), 0u);
  EXPECT_EQ(count(torus(16)), 0u);
}

TEST(SelfIntersections, OfTwoToriThroughEachOtherAreFoundByAnyIndex) {
  Surface other = moved(torus(12), {3, 0, 0});
  for (Vec3& v : other.vertices) v = Vec3(v.x(), v.z(), v.y());
  EXPECT_EQ(count(together(torus(12), other)), 0u);  // linked like a chain
  EXPECT_GT(count(together(torus(12), moved(torus(12), {1, 0.25, 0}))), 20u);
}

TEST(SelfIntersections, OfLongTrianglesAmongShortOnesAreFound) {
  const Surface blade{{{-9, 0.1, 0.1}, {9, 0.1, 0.2}, {9, 0.2, 0.1}}, {{0, 1, 2}}};
  EXPECT_GT(count(together(torus(12), blade)), 0u);
}

TEST(SelfIntersections, OfTheGeneratedSolidsThereAreNone) {
  for (const Shape& shape : shapes_to_try()) {
    if (shape.kind != ShapeKind::solid) continue;
    const auto mesh = mesh_of(shape.make());
    EXPECT_EQ(count_self_intersections(*mesh, PdTree(mesh)), 0u) << shape.name;
  }
}

TEST(FindSelfIntersections, ReportsEachTriangleThatItHasExamined) {
  const auto mesh = mesh_of(make_cube(5.0));
  std::size_t examined = 0;
  find_self_intersections(*mesh, PdTree(mesh), 10, [&] { ++examined; });
  EXPECT_EQ(examined, mesh->triangle_count());
}

/// Returns the place where the two triangles of a mesh meet.
Vec3 place_of(const Mesh& mesh) {
  const auto shared = std::make_shared<const Mesh>(mesh);
  return find_self_intersections(*shared, PdTree(shared)).places.places.at(0).at;
}

TEST(FindSelfIntersections, PlacesAreOnBothTriangles) {
  const Vec3 base_middle = Vec3(4, 4, 0) / 3;
  // A duplicate, a smaller triangle inside, and a star with all corners outside the other.
  for (const Surface& flat :
       {Surface{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {1, 2, 0}}},
        beside_base(base_middle, base_middle + Vec3(0.1, -0.1, 0), base_middle + Vec3(0, 0.1, 0)),
        beside_base({3, 3, 0}, {-1, 3, 0}, {3, -1, 0})}) {
    const Vec3 at = place_of(Mesh(flat));
    EXPECT_NEAR((at - base_middle).norm(), 0.0, 0.3);
  }
  // Triangles that touch at a corner, along an edge in the plane, and where edges cross.
  EXPECT_EQ(place_of(Mesh(beside_base({1, 1, 0}, {9, 9, 9}, {-9, 1, 9}))), Vec3(1, 1, 0));
  EXPECT_EQ(place_of(Mesh(beside_base({1, 1, 0}, {1, 2, 0}, {9, 9, 9}))), Vec3(1, 1.5, 0));
  EXPECT_EQ(place_of(Mesh(beside_base({1, 0, -1}, {1, 0, 1}, {1, -9, 0}))), Vec3(1, 0, 0));
  EXPECT_EQ(place_of(Mesh(on_base_edge({1, 1, 0}))).z(), 0.0);
}

TEST(FindSelfIntersections, PlacesAreWhereTheBoxesOfBothTrianglesAre) {
  Random random(20261126);
  std::size_t found = 0;
  for (const double unit : {1.0, 1e30 / 8, 1e-100, 1e-105, 1e-110}) {
    for (int trial = 0; trial < 4'000; ++trial) {
      Surface surface{{}, {{0, 1, 2}, {3, 4, 5}}};
      for (int v = 0; v < 6; ++v) {
        const auto whole = [&] { return 3.0 + static_cast<double>(random.below(4)); };
        surface.vertices.push_back(unit * Vec3(whole(), whole(), whole()));
      }
      const auto mesh = std::make_shared<const Mesh>(weld(surface));
      for (const FaultPlace& place :
           find_self_intersections(*mesh, BruteForce(mesh)).places.places) {
        ++found;
        for (const TriangleId t : {0u, 1u}) {
          const Triangle triangle = mesh->triangle(t);
          for (int axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
            EXPECT_GE(place.at[axis], low) << unit << ' ' << trial;
            EXPECT_LE(place.at[axis], high) << unit << ' ' << trial;
          }
        }
      }
    }
  }
  EXPECT_GT(found, 1'000u);
}

TEST(FindSelfIntersections, PlacesAreWhereTrianglesMeet) {
  const auto crossing = mesh_of(beside_base({1, 1, -1}, {1, 1, 1}, {1, 9, 0}));
  const SelfIntersections found = find_self_intersections(*crossing, PdTree(crossing));
  EXPECT_EQ(found.pairs, 1u);
  ASSERT_EQ(found.places.places.size(), 1u);
  const FaultPlace& place = found.places.places[0];
  EXPECT_EQ(place.corners.size(), 6u);
  // They meet from (1, 1, 0) to (1, 3, 0).
  EXPECT_NEAR((place.at - Vec3(1, 2, 0)).norm(), 0.0, 1e-12);
  const auto flat = mesh_of(beside_base({1, 1, 0}, {9, 1, 0}, {1, 9, 0}));
  // They share the triangle (1, 1), (3, 1), (1, 3).
  EXPECT_NEAR((place_of(*flat) - Vec3(5, 5, 0) / 3).norm(), 0.0, 1e-12);
  EXPECT_TRUE(find_self_intersections(*flat, PdTree(flat), 0).places.places.empty());
}

}  // namespace
}  // namespace keepout
