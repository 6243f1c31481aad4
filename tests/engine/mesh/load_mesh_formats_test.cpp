// SPDX-License-Identifier: BSD-3-Clause
// Properties of single formats, well-formed and malformed.
#include <Eigen/Geometry>

#include "engine/mesh/mesh_files.h"

namespace keepout {
namespace {

// Polygons.

double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle c = mesh.triangle(t);
    area += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).z();
  }
  return area;
}

TEST_F(LoadMesh, PolygonsAreCutIntoTrianglesWoundAlike) {
  const LoadedMesh off = load("mesh.off", square_off);
  EXPECT_EQ(off.mesh->triangle_count(), 2u);
  EXPECT_DOUBLE_EQ(area_of(*off.mesh), 1.0);
  // An L of six corners: a fan from the first corner would not cover it correctly.
  const LoadedMesh obj = load("mesh.obj",
                              "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\n"
                              "f -6 -5 -4 -3 -2 -1\n");
  EXPECT_EQ(obj.mesh->triangle_count(), 4u);
  EXPECT_DOUBLE_EQ(area_of(*obj.mesh), 3.0);
  for (TriangleId t = 0; t < 4; ++t) EXPECT_EQ(obj.mesh->normal(t), Vec3(0, 0, 1)) << t;
}

TEST_F(LoadMesh, AConcavePolygonWithADoubledCornerIsFilledOnce) {
  // An L of area 700 that starts at the corner `first` and has the corner `doubled` twice.
  const std::vector<Vec3> corners{{40, 0, 0},  {40, 10, 0}, {10, 10, 0},
                                  {10, 40, 0}, {0, 40, 0},  {0, 0, 0}};
  for (std::size_t doubled = 0; doubled < corners.size(); ++doubled) {
    for (std::size_t first = 0; first < corners.size(); ++first) {
      std::string vertices, face = "f";
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t corner = (first + i) % corners.size();
        for (int times = corner == doubled ? 2 : 1; times > 0; --times) {
          vertices += "v " + row(corners[corner]);
          face += " " + std::to_string(std::count(vertices.begin(), vertices.end(), 'v'));
        }
      }
      const LoadedMesh loaded = load("mesh.obj", vertices + face + "\n");
      EXPECT_EQ(loaded.mesh->triangle_count(), 5u) << doubled << " from " << first;
      EXPECT_DOUBLE_EQ(area_of(*loaded.mesh), 700.0) << doubled << " from " << first;
      for (TriangleId t = 0; t < 5; ++t) {
        const Triangle c = loaded.mesh->triangle(t);
        EXPECT_GE((c[1] - c[0]).cross(c[2] - c[0]).z(), 0.0) << doubled << " from " << first;
      }
    }
  }
}

TEST_F(LoadMesh, PolygonsOfAnySizeAreRead) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n";
  std::string off = "OFF\n12 1 0\n";
  std::string corners = "12";
  for (int i = 0; i < 12; ++i) {
    const std::string point = number(std::cos(i * 0.5)) + " " + number(std::sin(i * 0.5)) + " 0\n";
    ply += point;
    off += point;
    corners += " " + std::to_string(i);
  }
  EXPECT_EQ(load("mesh.ply", ply + corners + "\n").mesh->triangle_count(), 10u);
  EXPECT_EQ(load("mesh.off", off + corners + "\n").mesh->triangle_count(), 10u);
}

TEST_F(LoadMesh, FacesOfFewerThanThreeCornersAreLeftOutWithAWarning) {
  const LoadedMesh loaded =
      load_unchecked("mesh.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n1 2\n");
  EXPECT_EQ(loaded.mesh->triangle_count(), 1u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "2 faces");
}

// Counts in headers.

TEST_F(LoadMesh, CountsThatTheFileHasNoRoomForAreErrors) {
  for (const std::string_view count :
       {"4000000000", "18446744073709551615", "99999999999999999999", "-1", "1e3", "x"}) {
    for (const std::string_view which : {"vertex 3", "face 1"}) {
      const std::string name(which.substr(0, which.size() - 1));
      const std::string text =
          replaced(as_text_ply(single_triangle()), which, name + std::string(count));
      EXPECT_CONTAINS(complaint("mesh.ply", text), ": line ");
      const std::string binary = replaced(as_binary_ply<float>(single_triangle(), false), which,
                                          name + std::string(count));
      EXPECT_CONTAINS(complaint("mesh.ply", binary), ": line ");
    }
    const std::string counts = std::string(count);
    EXPECT_CONTAINS(
        complaint("mesh.off", "OFF\n" + counts + " 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        ": line ");
    EXPECT_CONTAINS(
        complaint("mesh.off", "OFF\n3 " + counts + " 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        ": line ");
  }
}

TEST_F(LoadMesh, AListLongerThanTheFileIsAnError) {
  std::string ply =
      replaced(as_binary_ply<float>(single_triangle(), false), "uchar int", "uint int");
  const std::size_t list = ply.size() - 15;  // 1 byte of length, 12 of corners, 2 of quality
  ply.replace(list, 1, "\xff\xff\xff\xff");
  EXPECT_CONTAINS(complaint("mesh.ply", ply), "cut short");
  // An unused list of 32 GB.
  ply = replaced(ply, "uint int vertex_indices\n",
                 "uint int others\nproperty list uchar int vertex_indices\n");
  EXPECT_CONTAINS(complaint("mesh.ply", ply), "cut short");
  EXPECT_CONTAINS(complaint("mesh.ply", replaced(as_text_ply(single_triangle()), "3 0 1 2 -7",
                                                 "4000000000 0 1 2")),
                  "fewer values");
  EXPECT_CONTAINS(complaint("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"),
                  "fewer corners");
}

TEST_F(LoadMesh, FewerFacesThanDeclaredIsAnErrorAndMoreAWarning) {
  EXPECT_CONTAINS(complaint("mesh.off", replaced(square_off, "4 1 0", "4 2 0")), "cut short");
  EXPECT_CONTAINS(complaint("mesh.ply", replaced(as_text_ply(tetrahedron()), "face 4", "face 5")),
                  "cut short");
  for (const LoadedMesh& loaded :
       {load_unchecked("mesh.off", std::string(square_off) + "3 0 1 2\n"),
        load_unchecked("mesh.ply", as_text_ply(single_triangle()) + "3 0 1 2 -7\n"),
        load_unchecked("mesh.ply", as_binary_ply<float>(single_triangle(), false) + "more")}) {
    ASSERT_EQ(loaded.warnings.size(), 1u);
    EXPECT_CONTAINS(loaded.warnings[0], "more in the file");
  }
}

TEST_F(LoadMesh, FewerVerticesThanAPlyFileDeclaresAreCounted) {
  const std::string ply = as_text_ply(single_triangle());
  EXPECT_CONTAINS(complaint("mesh.ply", replaced(ply, "vertex 3", "vertex 5")),
                  "line 16: 5 values, but by the header each 'vertex' has 4: the header lacks a "
                  "property, or the file has only 3 of the 5 'vertex' that it declares");
}

TEST_F(LoadMesh, IndicesOfVerticesThatAreNotThereAreErrors) {
  for (const std::string_view bad : {"4", "4294967295", "4294967296", "-1", "x", "1.0"}) {
    const std::string index(bad);
    EXPECT_CONTAINS(complaint("mesh.off", replaced(square_off, "0 1 2 3", "0 1 2 " + index)),
                    ": line 7");
    EXPECT_CONTAINS(complaint("mesh.ply", replaced(as_text_ply(single_triangle()), "3 0 1 2",
                                                   "3 0 1 " + index)),
                    ": line ");
  }
  for (const std::string_view bad :
       {"4", "0", "-4", "1.0", "x", "1e0", "/1", "99999999999999999999"}) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + std::string(bad) + "\n";
    EXPECT_CONTAINS(complaint("mesh.obj", text), ": line 4");
  }
  Surface surface = single_triangle();
  surface.triangles[0][2] = 3;
  EXPECT_CONTAINS(complaint("mesh.ply", as_binary_ply<float>(surface, false)), "names vertex 3");
  surface.triangles[0][2] = 0x80000000u;
  EXPECT_CONTAINS(complaint("mesh.ply", as_binary_ply<float>(surface, true)), "negative");
}

// Single formats.

TEST_F(LoadMesh, ObjIndicesMayHaveLeadingZerosAndCountFromTheEnd) {
  const LoadedMesh loaded = load("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 01 002 -1\n");
  EXPECT_EQ(loaded.mesh->triangle_count(), 1u);
  EXPECT_EQ(loaded.mesh->triangle(0)[2], Vec3(0, 1, 0));
}

TEST_F(LoadMesh, ObjLinesMayContinueAndCarryComments) {
  const LoadedMesh loaded = load("mesh.obj",
                                 "# a triangle\nv 0 0 0 # first\nv 1 0 \\\n0\nv 0 1 0\n"
                                 "f 1 \\\n 2 \\\n 3 # that is all\n");
  EXPECT_EQ(loaded.mesh->triangle_count(), 1u);
  EXPECT_EQ(loaded.mesh->triangle(0)[1], Vec3(1, 0, 0));
}

TEST_F(LoadMesh, ObjVerticesMayHaveColoursAndAWeightOfOne) {
  const LoadedMesh loaded =
      load("mesh.obj", "v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1 1 1 1\nf 1 2 3\n");
  EXPECT_EQ(loaded.mesh->vertex_count(), 3u);
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0 2\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "line 1");
}

TEST_F(LoadMesh, ObjLinesAndPointsAreLeftOutWithAWarningAndAloneAreAnError) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\np 1\n";
  const LoadedMesh loaded = load_unchecked("mesh.obj", points + "f 1 2 3\n");
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "2 lines or points");
  EXPECT_CONTAINS(complaint("mesh.obj", points), "no faces");
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), "line 3");
}

TEST_F(LoadMesh, ObjFreeFormSurfacesAreAnError) {
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0\ncstype bspline\nsurf 0 1 0 1 1\n"), "free-form");
}

TEST_F(LoadMesh, ObjStatementsThatAreUnknownAreLeftOutWithAWarning) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* known :
       {"mtllib a.mtl", "o a", "g a b", "s off", "usemtl a", "vt 0 0", "vn 0 0 1", "vp 0 0",
        "lod 1", "bevel on", "shadow_obj a", "maplib a"}) {
    EXPECT_TRUE(load_unchecked("mesh.obj", triangle + known + "\n").warnings.empty()) << known;
  }
  const LoadedMesh loaded = load_unchecked("mesh.obj", triangle + "F 1 3 2\n\x1b 3 2 1\n");
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "2 lines");
  EXPECT_CONTAINS(loaded.warnings[0], "line 5: 'F'");
  EXPECT_CONTAINS(complaint("mesh.obj", triangle + "call other.obj\n"), "line 5: ");
}

TEST_F(LoadMesh, AnObjVertexWithMoreThanNumbersIsAnError) {
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0\nv 1 0 0 v 0 1 0\nv 5 5 5\nf 1 2 3\n"),
                  "line 2: ");
}

TEST_F(LoadMesh, OffMayCarryCommentsAndColours) {
  const LoadedMesh loaded =
      load("mesh.off",
           "COFF # colours\n# counts\n3 1 0\n0 0 0 255 0 0 255\n\n"
           "1 0 0 255 0 0 255 # second\n0 1 0 255 0 0 255\n3 0 1 2 0.5 0.5 0.5\n");
  EXPECT_EQ(loaded.mesh->triangle_count(), 1u);
  EXPECT_EQ(loaded.mesh->triangle(0)[1], Vec3(1, 0, 0));
}

TEST_F(LoadMesh, OffCountsMayFollowTheKeywordOrStandAlone) {
  const std::string rest = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(load("mesh.off", "OFF 3 1 0\n" + rest).mesh->triangle_count(), 1u);
  EXPECT_EQ(load("mesh.off", "3 1 0\n" + rest).mesh->triangle_count(), 1u);
  EXPECT_CONTAINS(complaint("mesh.off", "OFF BINARY\n" + rest), "binary OFF");
  EXPECT_CONTAINS(complaint("mesh.off", "4OFF\n3 1 0\n" + rest), "expected 'OFF'");
}

TEST_F(LoadMesh, OffLinesOfAnyLengthAreHarmless) {
  const std::string text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0 #" + std::string(100'000, 'x') +
                           "\n3 0 1 2" + std::string(100'000, ' ') + "255\n";
  EXPECT_EQ(load("mesh.off", text).mesh->triangle_count(), 1u);
}

TEST_F(LoadMesh, PlyStripsAndPointCloudsAreErrors) {
  const std::string ply = as_text_ply(single_triangle());
  EXPECT_CONTAINS(complaint("mesh.ply", replaced(ply, "element face 1", "element tristrips 1")),
                  "strips");
  EXPECT_CONTAINS(complaint("mesh.ply",
                            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                            "property float y\nproperty float z\nend_header\n0 0 0\n"),
                  "no faces");
}

TEST_F(LoadMesh, PlyHeadersThatAreNotUnderstoodAreErrorsWithTheirLine) {
  const std::string ply = as_text_ply(single_triangle());
  expect_faults("mesh.ply", ply,
                {{"float x", "quaternion x", "line 5: unknown type"},
                 {"ascii 1.0", "ascii 2.0", "line 2"},
                 {"ascii", "morse", "line 2"},
                 {"comment made", "remark made", "line 3"},
                 {"list uchar", "list float", "line 10"},
                 {"float z", "float height", "no z"},
                 {"vertex_indices", "corners", "vertex_indices"},
                 {"element vertex", "element point", "no vertices"}});
  EXPECT_CONTAINS(complaint("mesh.ply", ply.substr(0, ply.find("end_header"))),
                  "within its header");
}

TEST_F(LoadMesh, APlyPropertyThatIsDeclaredTwiceIsAnError) {
  const std::string ply = as_text_ply(single_triangle());
  EXPECT_CONTAINS(complaint("mesh.ply", replaced(ply, "uchar red", "float x")), "its x twice");
  EXPECT_CONTAINS(
      complaint("mesh.ply", replaced(ply, "short quality", "list uchar int vertex_index")),
      "its vertex_indices twice");
}

TEST_F(LoadMesh, APlyHeaderThatDoesNotEndIsReadNoFurtherThanHeadersGo) {
  const fs::path file = folder.write("mesh.ply", "ply\nformat ascii 1.0\ncomment ");
  fs::resize_file(file, std::uintmax_t{1} << 28);  // a hole, which uses no disk space
  EXPECT_CONTAINS(complaint(file), "header");
  EXPECT_CONTAINS(complaint(file), "16 MiB");
}

TEST_F(LoadMesh, PlyElementsThatAreNotAskedForArePassedOver) {
  std::string ply = as_binary_ply<float>(single_triangle(), false);
  ply = replaced(ply, "element vertex",
                 "element camera 2\nproperty double f\nproperty list uchar "
                 "short x\nelement vertex");
  const std::string body_begin = "end_header\n";
  std::string cameras(8, '\x01');
  cameras += std::string("\x02\x05\x05\x05\x05", 5) + std::string(8, '\x02') + std::string(1, '\0');
  ply.insert(ply.find(body_begin) + body_begin.size(), cameras);
  const LoadedMesh loaded = load("mesh.ply", ply);
  EXPECT_EQ(loaded.mesh->triangle(0)[1], Vec3(1, 0, 0));
  EXPECT_EQ(loaded.mesh->triangle(0)[2], Vec3(0, 1, 0));
}

TEST_F(LoadMesh, TextStlMayHaveSeveralSolidsAndAnyLayout) {
  const std::string one = as_text_stl(tetrahedron());
  EXPECT_EQ(load("mesh.stl", one + one).mesh->triangle_count(), 8u);
  EXPECT_EQ(
      load("mesh.stl",
           "SOLID\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0\nVERTEX 0\n1 "
           "0 ENDLOOP ENDFACET\nENDSOLID")
          .mesh->triangle_count(),
      1u);
}

TEST_F(LoadMesh, TextStlThatIsMalformedIsAnErrorWithItsLine) {
  const std::string stl = as_text_stl(single_triangle());
  expect_faults("mesh.stl", stl,
                {{"endsolid", "endsolit", "line 9: expected 'facet'"},
                 {"  endloop\n", "", "line 7: expected 'endloop'"},
                 {"    vertex 1 0 0\n", "", "expected 'vertex', found 'endloop'"},
                 {"vertex 1 0 0", "vertex 1 0 0\nvertex 1 1 0", "more than three corners"},
                 {"vertex 1 0 0", "vertex 1 0", "expected a number, found 'vertex'"},
                 {"facet normal 0 0 1", "facet", "expected 'normal'"}});
  EXPECT_CONTAINS(complaint("mesh.stl", "solid\nendsolid\n"), "no faces");
  EXPECT_CONTAINS(complaint("mesh.stl", stl.substr(0, stl.find("endsolid"))), "cut short");
}

TEST_F(LoadMesh, BinaryStlOfTheWrongLengthSaysWhatItDeclares) {
  const std::string stl = as_binary_stl(tetrahedron());
  EXPECT_CONTAINS(complaint("mesh.stl", stl.substr(0, 200)), "declares 4 triangles");
  EXPECT_CONTAINS(complaint("mesh.stl", stl + "more"), "follows the mesh");
  std::string begins_with_solid = stl.substr(0, 200);
  begins_with_solid.replace(0, 6, "solid ");
  EXPECT_CONTAINS(complaint("mesh.stl", begins_with_solid), "declares 4 triangles");
}

}  // namespace
}  // namespace keepout
