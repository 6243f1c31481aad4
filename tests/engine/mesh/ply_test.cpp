// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>

#include "engine/mesh/mesh_files.h"
#include "mesh_file.h"

namespace keepout {
namespace {

class BinaryPly : public testing::Test {
 protected:
  MeshFile read(std::string_view contents) {
    return read_ply(MeshSource(folder.write("mesh.ply", contents)));
  }

  std::string complaint(std::string_view contents) {
    return error_of([&] { read(contents); });
  }

  TemporaryFolder folder;
};

/// Returns a file with a polygon in the plane z = 0, after a triangle of its first corners.
std::string polygon_ply(const std::vector<Vec3>& points) {
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(points.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\nelement face 2\n"
                    "property list int uint vertex_indices\nend_header\n";
  for (const Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) append_bytes(ply, p[axis], false);
  }
  for (const std::uint32_t number : {3u, 0u, 1u, 2u}) append_bytes(ply, number, false);
  append_bytes(ply, static_cast<std::uint32_t>(points.size()), false);
  for (std::uint32_t i = 0; i < points.size(); ++i) append_bytes(ply, i, false);
  return ply;
}

double doubled_area_of(const Surface& surface, std::size_t t) {
  const Corners& c = surface.triangles[t];
  const Vec3 one = surface.vertices[c[1]] - surface.vertices[c[0]];
  const Vec3 other = surface.vertices[c[2]] - surface.vertices[c[0]];
  return one.cross(other).z();
}

TEST_F(BinaryPly, ManyTrianglesAreReadAsTheyAre) {
  const Surface expected = torus(150);  // several blocks, both of vertices and of triangles
  for (const bool big_endian : {false, true}) {
    const MeshFile read = this->read(as_binary_ply<double>(expected, big_endian));
    EXPECT_EQ(read.surface.vertices, expected.vertices);
    EXPECT_EQ(read.surface.triangles, expected.triangles);
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST_F(BinaryPly, APolygonIsCoveredOnceHoweverItIsBent) {
  const std::vector<std::vector<Vec3>> polygons{
      {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}},
      {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}},                    // an arrow
      {{2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}},  // an L
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}},  // with collinear corners
      {{0, 0, 0},
       {6, 0, 0},
       {6, 3, 0},
       {5, 3, 0},
       {5, 1, 0},
       {4, 1, 0},
       {4, 3, 0},
       {3, 3, 0},
       {3, 1, 0},
       {2, 1, 0},
       {2, 3, 0},
       {0, 3, 0}}};  // a comb
  const std::vector<double> areas{2.0, 1.0, 3.0, 2.0, 14.0};
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    SCOPED_TRACE(p);
    const Surface surface = read(polygon_ply(polygons[p])).surface;
    ASSERT_EQ(surface.triangles.size(), polygons[p].size() - 1);
    double area = 0.0;
    for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
      // No triangle is flipped. With the right total area, no area is outside or covered twice.
      EXPECT_GE(doubled_area_of(surface, t), 0.0);
      area += 0.5 * doubled_area_of(surface, t);
    }
    EXPECT_NEAR(area, areas[p], 1e-12);
  }
}

TEST_F(BinaryPly, APolygonMayLieInAnyPlane) {
  std::vector<Vec3> points{{2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}};
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7 * i, Vec3(1.0, i - 9.5, 0.3).normalized()));
    std::vector<Vec3> turned;
    for (const Vec3& p : points) turned.push_back(turn * p + Vec3(5, 6, 7));
    const Surface surface = read(polygon_ply(turned)).surface;
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
      const Corners& c = surface.triangles[t];
      const Vec3 one = surface.vertices[c[1]] - surface.vertices[c[0]];
      const Vec3 other = surface.vertices[c[2]] - surface.vertices[c[0]];
      const Vec3 normal = 0.5 * one.cross(other);
      EXPECT_GT(normal.dot(turn * Vec3(0, 0, 1)), 0.0);
      sum += normal;
    }
    EXPECT_NEAR(sum.norm(), 3.0, 1e-9);
  }
}

TEST_F(BinaryPly, APolygonWithoutAnAreaHasAsManyTrianglesAsAnyOther) {
  EXPECT_EQ(read(polygon_ply(std::vector<Vec3>(7, Vec3(1, 1, 1)))).surface.triangles.size(), 6u);
  EXPECT_EQ(
      read(polygon_ply({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}})).surface.triangles.size(), 3u);
}

TEST_F(BinaryPly, ALargePolygonIsReadIfItIsConvex) {
  std::vector<Vec3> circle;
  for (int i = 0; i < 20'000; ++i) {
    circle.emplace_back(std::cos(i * 3.14159e-4), std::sin(i * 3.14159e-4), 0.0);
  }
  EXPECT_EQ(read(polygon_ply(circle)).surface.triangles.size(), 19'999u);
  std::swap(circle[5], circle[6]);
  EXPECT_CONTAINS(complaint(polygon_ply(circle)), "not convex");
}

TEST_F(BinaryPly, FacesOfFewerThanThreeCornersAreLeftOutWithAWarning) {
  const MeshFile two = read(polygon_ply({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(two.surface.triangles.size(), 2u);
  std::string ply = polygon_ply({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  ply.resize(ply.size() - 4);
  ply[ply.size() - 12] = 2;
  const MeshFile one = read(ply);
  EXPECT_EQ(one.surface.triangles.size(), 1u);
  ASSERT_EQ(one.warnings.size(), 1u);
  EXPECT_CONTAINS(one.warnings[0], "1 faces");
}

TEST_F(BinaryPly, FacesMayStandBeforeTheVerticesAndListsAnywhere) {
  std::string ply =
      "ply\r\nformat binary_big_endian 1.0\r\nelement face 1\r\nproperty list uchar short a\r\n"
      "property list uchar ushort vertex_index\r\nelement vertex 4\r\nproperty short x\r\n"
      "property list uchar double b\r\nproperty int8 y\r\nproperty double z\r\nend_header\r\n";
  ply += std::string("\x02....\x04\x00\x00\x00\x01\x00\x02\x00\x03", 14);
  const std::vector<Vec3> points{{0, 0, 0.1}, {300, 0, 0}, {300, -5, 0}, {0, -5, 0}};
  for (const Vec3& p : points) {
    append_bytes(ply, static_cast<std::int16_t>(p.x()), true);
    ply += '\x01' + std::string(8, 'x');
    append_bytes(ply, static_cast<std::int8_t>(p.y()), true);
    append_bytes(ply, p.z(), true);
  }
  const MeshFile read = this->read(ply);
  EXPECT_EQ(read.surface.vertices, points);
  EXPECT_EQ(read.surface.triangles.size(), 2u);
  EXPECT_TRUE(read.warnings.empty());
}

TEST_F(BinaryPly, CutShortAnywhereItIsAnError) {
  const std::string whole = polygon_ply({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    ASSERT_NE(complaint(whole.substr(0, length)), "no error") << length;
  }
}

TEST_F(BinaryPly, AnErrorNamesTheFaceThatItIsIn) {
  const std::string whole = polygon_ply({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}});
  std::string names_none = whole;
  names_none[whole.size() - 1] = '\x01';  // an invalid last corner
  std::string negative = whole;
  for (std::size_t i = 17; i <= 20; ++i) negative[whole.size() - i] = '\xff';
  for (const std::string& damaged : {names_none, negative, whole.substr(0, whole.size() - 1)}) {
    EXPECT_CONTAINS(complaint(damaged), "'face' 1: ");
  }
}

}  // namespace
}  // namespace keepout
