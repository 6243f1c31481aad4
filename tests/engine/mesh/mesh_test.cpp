// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/mesh.h"

#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout {
namespace {

std::string message_of(const Surface& surface) {
  return error_of([&] { Mesh{surface}; });
}

TEST(Mesh, GivesBackWhatItWasMadeFrom) {
  const Surface surface = torus(7);
  const Mesh mesh(surface);
  ASSERT_EQ(mesh.triangle_count(), surface.triangles.size());
  ASSERT_EQ(mesh.vertex_count(), surface.vertices.size());
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    ASSERT_EQ(mesh.corners(t), surface.triangles[t]);
    ASSERT_EQ(mesh.corners(t), mesh.triangles()[t]);
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(mesh.triangle(t)[i], surface.vertices[surface.triangles[t][i]]);
      ASSERT_EQ(mesh.triangle(t)[i], mesh.vertices()[mesh.corners(t)[i]]);
    }
  }
}

TEST(Mesh, NormalFollowsTheWinding) {
  EXPECT_EQ(Mesh(single_triangle()).normal(0), Vec3(0, 0, 1));
  EXPECT_EQ(Mesh(flipped(single_triangle())).normal(0), Vec3(0, 0, -1));
}

TEST(Mesh, NormalOfATriangleWithoutAnAreaIsZero) {
  EXPECT_EQ(Mesh({{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 1, 2}}}).normal(0), Vec3::Zero());
  EXPECT_EQ(Mesh({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}}).normal(0), Vec3::Zero());
}

TEST(Mesh, BoundsAreTheTightBoxOfTheTriangles) {
  Surface surface = moved(tetrahedron(), {-5, 2, 7});
  surface.vertices.emplace_back(100, 100, 100);  // no triangle uses it
  const Mesh mesh(surface);
  EXPECT_EQ(mesh.bounds().low, Vec3(-5, 2, 7));
  EXPECT_EQ(mesh.bounds().high, Vec3(-4, 3, 8));
}

TEST(Mesh, WithoutTrianglesIsAnError) {
  EXPECT_CONTAINS(message_of({}), "no triangles");
  EXPECT_CONTAINS(message_of({{{0, 0, 0}}, {}}), "no triangles");
}

TEST(Mesh, ACoordinateThatIsNotFiniteIsAnErrorNamingTheVertex) {
  for (const double bad : {test::nan, test::infinity, -test::infinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Surface surface = tetrahedron();
      surface.vertices[2][axis] = bad;
      EXPECT_CONTAINS(message_of(surface), "vertex 2");
    }
  }
}

TEST(Mesh, ATriangleOfAVertexThatIsNotThereIsAnErrorNamingBoth) {
  Surface surface = tetrahedron();
  surface.triangles[3][1] = 4;
  const std::string message = message_of(surface);
  EXPECT_CONTAINS(message, "triangle 3");
  EXPECT_CONTAINS(message, "vertex 4");
}

}  // namespace
}  // namespace keepout
