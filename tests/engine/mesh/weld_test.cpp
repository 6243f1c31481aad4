// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <map>

#include "keepout/error.h"
#include "meshes.h"

namespace keepout {
namespace {

TEST(Weld, MergesVerticesThatAreExactlyEqual) {
  const Surface welded = weld(unwelded(tetrahedron()));
  EXPECT_EQ(welded.vertices.size(), 4u);
  EXPECT_EQ(welded.triangles.size(), 4u);
}

TEST(Weld, LeavesVerticesApartThatDifferInTheLastBit) {
  for (int axis = 0; axis < 3; ++axis) {
    Surface surface = unwelded(single_triangle());
    surface.vertices.push_back(surface.vertices[1]);
    double& coordinate = surface.vertices.back()[axis];
    coordinate = std::nextafter(coordinate, 2.0);
    surface.triangles.push_back({0, 3, 2});
    EXPECT_EQ(weld(surface).vertices.size(), 4u) << axis;
  }
}

TEST(Weld, TakesMinusZeroForZero) {
  Surface surface = single_triangle();
  surface.vertices.emplace_back(-0.0, 0.0, -0.0);
  surface.triangles.push_back({3, 2, 1});
  const Surface welded = weld(surface);
  EXPECT_EQ(welded.vertices.size(), 3u);
  EXPECT_EQ(welded.triangles[1][0], welded.triangles[0][0]);
}

TEST(Weld, KeepsTheOrderTheWindingAndTheFirstCornerOfEveryTriangle) {
  const Surface given = unwelded(shuffled(torus(9), 1));
  const Surface welded = weld(given);
  ASSERT_EQ(welded.triangles.size(), given.triangles.size());
  for (std::size_t t = 0; t < given.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(welded.vertices[welded.triangles[t][i]], given.vertices[given.triangles[t][i]]);
    }
  }
}

TEST(Weld, NumbersVerticesByTheirFirstUse) {
  const Surface welded = weld(shuffled(torus(9), 2));
  VertexId next = 0;
  for (const Corners& corners : welded.triangles) {
    for (const VertexId v : corners) {
      ASSERT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
  EXPECT_EQ(next, welded.vertices.size());
}

TEST(Weld, DropsVerticesThatNoTriangleUses) {
  Surface surface = tetrahedron();
  surface.vertices.insert(surface.vertices.begin(), Vec3(9, 9, 9));
  for (Corners& corners : surface.triangles) {
    for (VertexId& v : corners) ++v;
  }
  const Surface welded = weld(surface);
  EXPECT_EQ(welded.vertices.size(), 4u);
  EXPECT_EQ(welded.vertices[0], Vec3(0, 0, 0));
}

TEST(Weld, KeepsTrianglesThatItMakesDegenerate) {
  const Surface welded = weld({{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}, {2, 1, 0}}});
  EXPECT_EQ(welded.vertices.size(), 2u);
  ASSERT_EQ(welded.triangles.size(), 2u);
  EXPECT_EQ(welded.triangles[0], (Corners{0, 0, 1}));
  EXPECT_EQ(welded.triangles[1], (Corners{1, 0, 0}));
}

TEST(Weld, ChangesNothingTheSecondTime) {
  const Surface once = weld(unwelded(shuffled(torus(12), 3)));
  const Surface twice = weld(once);
  EXPECT_EQ(once.vertices, twice.vertices);
  EXPECT_EQ(once.triangles, twice.triangles);
}

TEST(Weld, AgreesWithASortedMapOnPointsThatOftenCoincide) {
  // Small integers have almost equal bits, which is hard for a hash.
  std::mt19937 random(4);
  Surface given;
  for (VertexId i = 0; i < 60'000; ++i) {
    given.vertices.emplace_back(random() % 32, random() % 32, static_cast<int>(random() % 32) - 16);
    if (i % 3 == 2) given.triangles.push_back({i - 2, i - 1, i});
  }
  const Surface welded = weld(given, 2);
  std::map<std::array<double, 3>, VertexId> numbers;
  for (std::size_t t = 0; t < given.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& v = given.vertices[given.triangles[t][i]];
      const auto fresh = static_cast<VertexId>(numbers.size());
      const VertexId expected = numbers.try_emplace({v.x(), v.y(), v.z()}, fresh).first->second;
      ASSERT_EQ(welded.triangles[t][i], expected);
    }
  }
  EXPECT_EQ(welded.vertices.size(), numbers.size());
}

TEST(Weld, ATriangleOfVerticesThatAreNotThereIsAnError) {
  Surface surface = single_triangle();
  surface.triangles.push_back({0, 1, 3});
  EXPECT_THROW(weld(surface), Error);
}

TEST(Weld, OfNothingIsNothing) {
  const Surface welded = weld({});
  EXPECT_TRUE(welded.vertices.empty());
  EXPECT_TRUE(welded.triangles.empty());
}

}  // namespace
}  // namespace keepout
