// SPDX-License-Identifier: BSD-3-Clause
#include "record/drawn_mesh.h"

#include <gtest/gtest.h>

#include "apps/page/unpacked_page.h"
#include "keepout/fixtures/shapes.h"

namespace keepout::app {
namespace {

Mesh fine_sphere() { return Mesh(make_sphere(1.5)); }

TEST(DrawnMesh, HasEveryBitOfAMeshOfModestSize) {
  const Mesh mesh = fine_sphere();
  const Json json = drawn_mesh("<ball>", mesh);
  EXPECT_EQ(json["name"], "<ball>");
  EXPECT_EQ(json["triangles"], mesh.triangle_count());
  const Json& drawn = json["drawn"];
  EXPECT_EQ(drawn["triangles"], mesh.triangle_count());
  const auto bytes = test::gunzipped(test::from_base64(drawn["packed"].get<std::string>()));
  EXPECT_TRUE(test::same_bits(test::unpacked(drawn["coordinates"].get<std::string>(), bytes,
                                             mesh.vertex_count(), mesh.triangle_count()),
                              mesh));
}

TEST(DrawnMesh, ACoarserOneIsNearTheSurfaceAndWholeWhereOneLooksClosely) {
  const Mesh mesh = fine_sphere();
  const Box top{{-60, -60, 45}, {60, 60, 60}};
  constexpr std::size_t most = 2000;
  const Surface coarse = coarsened(mesh, most, std::nullopt);
  EXPECT_LE(coarse.triangles.size(), most);
  EXPECT_GT(coarse.triangles.size(), most / 8);
  for (const Vec3& vertex : coarse.vertices) EXPECT_NEAR(vertex.norm(), 50.0, 1e-3);

  // Triangles of the mesh with all corners in the box are all there, however many.
  const Surface close = coarsened(mesh, most, top);
  const auto within = [&](std::span<const Vec3> vertices, std::span<const Corners> triangles) {
    return std::ranges::count_if(triangles, [&](const Corners& corners) {
      return std::ranges::all_of(corners,
                                 [&](VertexId v) { return distance_to(top, vertices[v]) == 0.0; });
    });
  };
  EXPECT_EQ(within(close.vertices, close.triangles), within(mesh.vertices(), mesh.triangles()));
  const auto there = within(mesh.vertices(), mesh.triangles());
  EXPECT_LE(close.triangles.size(), most + static_cast<std::size_t>(there));
  EXPECT_GT(close.triangles.size(), most / 8 + static_cast<std::size_t>(there));
}

}  // namespace
}  // namespace keepout::app
