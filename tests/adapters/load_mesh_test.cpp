// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/load_mesh.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <iomanip>
#include <random>
#include <sstream>
#include <thread>

#include "keepout/error.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/weld.h"
#include "small_surfaces.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

// Writers of our own: no reader is tested with its own library's idea of a format.

/// How the writers write numbers: as short as 9 digits allow, unless told otherwise.
std::ios_base::fmtflags notation{};

std::string number(double value) {
  std::ostringstream text;
  text.setf(notation, std::ios_base::floatfield);
  text << std::setprecision(notation == std::ios_base::fixed ? 14 : 9) << value;
  return text.str();
}

std::string row(const Vec3& v) {
  return number(v.x()) + " " + number(v.y()) + " " + number(v.z()) + "\n";
}

std::string as_text_stl(const Surface& surface) {
  std::string text = "solid a name with facet in it\n";
  for (const Corners& corners : surface.triangles) {
    text += "facet normal 0 0 1\n  outer loop\n";
    for (const VertexId v : corners) text += "    vertex " + row(surface.vertices[v]);
    text += "  endloop\nendfacet\n";
  }
  return text + "endsolid a name with facet in it\n";
}

std::string as_off(const Surface& surface) {
  std::string text = "OFF\n" + std::to_string(surface.vertices.size()) + " " +
                     std::to_string(surface.triangles.size()) + " 0\n";
  for (const Vec3& v : surface.vertices) text += row(v);
  for (const Corners& c : surface.triangles) {
    text += "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) +
            "\n";
  }
  return text;
}

std::string as_obj(const Surface& surface) {
  std::string text = "mtllib nothing.mtl\no thing\n";
  for (const Vec3& v : surface.vertices) text += "v " + row(v);
  bool other = false;
  for (const Corners& c : surface.triangles) {
    // Materials change all the time: no reason to reorder the triangles.
    text += (other = !other) ? "usemtl one\n" : "usemtl two\n";
    text += "f " + std::to_string(c[0] + 1) + " " + std::to_string(c[1] + 1) + "//1 " +
            std::to_string(c[2] + 1) + "/2/3\n";
  }
  return text;
}

std::string ply_header(const std::string& format, const Surface& surface, const char* real) {
  const std::string type = std::string("property ") + real;
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " +
         std::to_string(surface.vertices.size()) + "\n" + type + " x\n" + type + " y\n" + type +
         " z\nproperty uchar red\nelement face " + std::to_string(surface.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nproperty short quality\nend_header\n";
}

std::string as_text_ply(const Surface& surface) {
  std::string text = ply_header("ascii", surface, "float");
  for (const Vec3& v : surface.vertices) {
    text += number(v.x()) + " " + number(v.y()) + " " + number(v.z()) + " 255\n";
  }
  for (const Corners& c : surface.triangles) {
    text += "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) +
            " -7\n";
  }
  return text;
}

template <class T>
void append_bytes(std::string& to, T value, bool big_endian) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  to += bytes;
}

template <class Real>
std::string as_binary_ply(const Surface& surface, bool big_endian) {
  std::string text = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", surface,
                                sizeof(Real) == sizeof(float) ? "float" : "double");
  for (const Vec3& v : surface.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      append_bytes(text, static_cast<Real>(v[axis]), big_endian);
    }
    text += '\x0a';
  }
  for (const Corners& c : surface.triangles) {
    text += '\x03';
    for (const VertexId v : c) append_bytes(text, v, big_endian);
    append_bytes(text, std::int16_t{-7}, big_endian);
  }
  return text;
}

std::string as_binary_stl(const Surface& surface) {
  const TemporaryFolder folder;
  write_binary_stl(folder.path() / "mesh.stl", surface);
  std::ifstream file(folder.path() / "mesh.stl", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Format {
  std::string name, file;
  std::function<std::string(const Surface&)> write;
};

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"BinaryStl", "mesh.stl", as_binary_stl},
      {"TextStl", "mesh.stl", as_text_stl},
      {"TextPly", "mesh.ply", as_text_ply},
      {"LittleEndianPly", "mesh.ply",
       [](const Surface& s) { return as_binary_ply<float>(s, false); }},
      {"BigEndianPly", "mesh.ply", [](const Surface& s) { return as_binary_ply<float>(s, true); }},
      {"DoublePly", "mesh.ply", [](const Surface& s) { return as_binary_ply<double>(s, false); }},
      {"Obj", "mesh.obj", as_obj},
      {"Off", "mesh.off", as_off}};
  return all;
}

/// A torus whose coordinates are short numbers, which every format holds exactly.
Surface round_torus() {
  Surface surface = torus(8);
  for (Vec3& v : surface.vertices) v = (64.0 * v.array()).round() / 64.0;
  return surface;
}

std::string format_name(const testing::TestParamInfo<Format>& format) { return format.param.name; }

class LoadMesh : public testing::Test {
 protected:
  LoadedMesh load(std::string_view name, std::string_view contents) const {
    return load_mesh(folder.write(name, contents));
  }

  /// What load_mesh says against the file; the test fails if it says nothing or not which file.
  std::string complaint(std::string_view name, std::string_view contents) const {
    return complaint(folder.write(name, contents));
  }
  static std::string complaint(const fs::path& path) {
    try {
      load_mesh(path);
    } catch (const Error& error) {
      EXPECT_TRUE(std::string_view(error.what()).starts_with(path.string())) << error.what();
      return std::string(error.what()).substr(path.string().size());
    }
    ADD_FAILURE() << "no error";
    return {};
  }

  TemporaryFolder folder;
};

#define EXPECT_CONTAINS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

class LoadMeshFormat : public LoadMesh, public testing::WithParamInterface<Format> {};

INSTANTIATE_TEST_SUITE_P(Formats, LoadMeshFormat, testing::ValuesIn(formats()), format_name);

TEST_P(LoadMeshFormat, GivesTheSameTrianglesInTheSameOrder) {
  const Surface surface = weld(round_torus());
  const LoadedMesh loaded = load(GetParam().file, GetParam().write(surface));
  ASSERT_EQ(loaded.mesh->triangle_count(), surface.triangles.size());
  EXPECT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
  for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
    ASSERT_EQ(loaded.mesh->corners(t), surface.triangles[t]) << t;
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(loaded.mesh->triangle(t)[i], surface.vertices[surface.triangles[t][i]]) << t;
    }
  }
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
}

TEST_P(LoadMeshFormat, ReadsAFileOfOneTriangle) {
  EXPECT_EQ(load(GetParam().file, GetParam().write(single_triangle())).mesh->triangle_count(), 1u);
}

TEST_P(LoadMeshFormat, TakesTheExtensionInAnyCase) {
  std::string name = GetParam().file;
  for (char& c : name) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(load(name, GetParam().write(tetrahedron())).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshFormat, CutShortAnywhereItIsAnErrorOrWarnsOfIt) {
  const std::string whole = GetParam().write(tetrahedron());
  const bool has_counts = GetParam().name != "Obj";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string contents = whole.substr(0, length);
    // White space is all that a text may lack; nothing is lost with it.
    const std::string_view lacking = std::string_view(whole).substr(length);
    const bool lacks_nothing = lacking.find_first_not_of(" \n") == std::string_view::npos;
    std::size_t triangles = 0;
    try {
      const LoadedMesh loaded = load(GetParam().file, contents);
      triangles = loaded.mesh->triangle_count();
      // OBJ has no counts: cut within a line it warns, and at the end of one nothing can tell.
      if (!has_counts && !contents.ends_with('\n')) {
        ASSERT_FALSE(loaded.warnings.empty()) << length;
      }
    } catch (const Error& error) {
      ASSERT_GT(std::strlen(error.what()), folder.path().string().size() + 10) << length;
    }
    if (has_counts && triangles > 0) {
      // The last number of a text, or the name after "endsolid", may be cut within itself.
      const bool within_last_word = lacking.find_first_of(" \n") == lacking.size() - 1;
      const bool within_name = whole.substr(0, length).find("endsolid") != std::string::npos;
      ASSERT_TRUE(lacks_nothing || within_last_word || within_name) << length;
      ASSERT_EQ(triangles, 4u) << length;
    }
  }
}

TEST_P(LoadMeshFormat, WithBytesChangedItLoadsOrIsAnErrorNamingTheFile) {
  const std::string whole = GetParam().write(tetrahedron());
  std::mt19937 random(7);
  constexpr std::string_view hostile("\0\n\r -.e/#\\0913xf\xff\x80", 19);
  int loaded = 0, refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string contents = whole;
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t at = random() % contents.size();
      switch (random() % 4) {
        case 0:
          contents[at] = hostile[random() % hostile.size()];
          break;
        case 1:
          contents[at] = static_cast<char>(random());
          break;
        case 2:
          contents.erase(at, 1 + random() % 8);
          break;
        default:
          contents.insert(at, contents.substr(random() % contents.size(), random() % 12));
      }
      if (contents.empty()) contents = "x";
    }
    const fs::path path = folder.write(GetParam().file, contents);
    try {
      ASSERT_GE(load_mesh(path).mesh->triangle_count(), 1u);
      ++loaded;
    } catch (const Error& error) {
      ASSERT_TRUE(std::string_view(error.what()).starts_with(path.string())) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 0);
}

/// The formats that are text, where layout is free.
class LoadMeshText : public LoadMeshFormat {};

INSTANTIATE_TEST_SUITE_P(Formats, LoadMeshText,
                         testing::Values(formats()[1], formats()[2], formats()[6], formats()[7]),
                         format_name);

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST_P(LoadMeshText, LineEndsMayBeThoseOfAnySystem) {
  const std::string text = GetParam().write(tetrahedron());
  for (const std::string_view line_end : {"\r\n", "\r", "\n\n", " \t\r\n  \r\n"}) {
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "\n", line_end));
    EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
    EXPECT_EQ(loaded.mesh->vertex_count(), 4u);
  }
}

TEST_P(LoadMeshText, TheLastLineNeedsNoEnd) {
  std::string text = GetParam().write(tetrahedron());
  text.pop_back();
  EXPECT_EQ(load(GetParam().file, text).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshText, AByteOrderMarkIsNoMatter) {
  const std::string text = "\xEF\xBB\xBF" + GetParam().write(tetrahedron());
  EXPECT_EQ(load(GetParam().file, text).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshText, NumbersThatAreNotFiniteAreErrorsWithTheirLine) {
  const Surface surface = moved(tetrahedron(), {0.25, 0, 0});
  const std::string text = GetParam().write(surface);
  for (const std::string_view bad : {"nan", "NaN", "-nan", "inf", "-Infinity"}) {
    const std::string message = complaint(GetParam().file, replaced(text, "0.25", bad));
    EXPECT_CONTAINS(message, ": line ");
    EXPECT_CONTAINS(message, "not finite");
  }
}

TEST_P(LoadMeshText, WhatIsNoNumberIsAnErrorWithItsLine) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  for (const std::string_view bad :
       {"0,25", "0.2.5", "0x1p3", "1e", "1d5", "--1", "1e99999", "12345678901234567890", "."}) {
    const std::string message = complaint(GetParam().file, replaced(text, "0.25", bad));
    EXPECT_CONTAINS(message, ": line ");
    EXPECT_CONTAINS(message, "expected a number, found '" + std::string(bad) + "'");
  }
}

TEST_P(LoadMeshText, ANumberBeyondSinglePrecisionIsAnError) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  EXPECT_CONTAINS(complaint(GetParam().file, replaced(text, "0.25", "1e39")), "not finite");
}

TEST_P(LoadMeshText, NumbersMayBeWrittenInAnyCommonWay) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  for (const std::string_view same :
       {".25", "+.25", "+0.25", "0.250", "25e-2", "2.5E-01", "00.25", "250.e-3", "0.025e+1"}) {
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", same));
    EXPECT_NEAR(loaded.mesh->bounds().low.x(), 0.25, 1e-7) << same;
    EXPECT_EQ(loaded.mesh->vertex_count(), 4u) << same;
  }
  // Even where the sign is followed by the point.
  const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", "-.25"));
  EXPECT_EQ(loaded.mesh->bounds().low.x(), -0.25);
}

int ulps_between(double a, double b) {
  const auto bits = [](double value) {
    return std::bit_cast<std::int32_t>(static_cast<float>(value));
  };
  return std::abs(bits(a) - bits(b));
}

TEST_P(LoadMeshText, TextIsReadToSinglePrecisionAsDocumented) {
  // What load_mesh.h promises; the numerals are those of single-precision numbers.
  const bool is_ply = GetParam().name == "TextPly";
  for (const double scale : {0.01, 1.0, 100.0}) {
    Surface surface = torus(40);
    for (Vec3& v : surface.vertices) v = (scale * v).cast<float>().cast<double>();
    for (const auto style : {std::ios_base::fixed, std::ios_base::scientific}) {
      notation = style;
      const std::string contents = GetParam().write(surface);
      notation = {};
      const LoadedMesh loaded = load(GetParam().file, contents);
      const int limit = is_ply ? 0 : style == std::ios_base::fixed ? 1 : 2;
      int worst = 0;
      for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
          const Vec3& expected = surface.vertices[surface.triangles[t][i]];
          for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(expected[axis]) < 1e-6) continue;  // 14 decimals do not hold it all
            worst =
                std::max(worst, ulps_between(loaded.mesh->triangle(t)[i][axis], expected[axis]));
          }
        }
      }
      EXPECT_LE(worst, limit) << "scale " << scale << ", notation " << style;
    }
  }
}

TEST_F(LoadMesh, BinaryCoordinatesAreExact) {
  Surface surface = torus(30);
  for (Vec3& v : surface.vertices) v = v.cast<float>().cast<double>();
  surface = weld(surface);
  for (const int f : {0, 3, 4, 5}) {
    const LoadedMesh loaded = load(formats()[f].file, formats()[f].write(surface));
    ASSERT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
    for (VertexId v = 0; v < surface.vertices.size(); ++v) {
      ASSERT_EQ(loaded.mesh->vertex(v), surface.vertices[v]) << formats()[f].name;
    }
  }
}

TEST_F(LoadMesh, DoublesInPlyAreRoundedToTheNearestSingle) {
  Surface surface = single_triangle();
  surface.vertices[1].x() = 0.1;
  const LoadedMesh loaded = load("mesh.ply", as_binary_ply<double>(surface, false));
  EXPECT_EQ(loaded.mesh->vertex(1).x(), double{0.1F});
}

TEST_F(LoadMesh, ABinaryPlyWhoseFirstByteIsALineFeedIsReadInPlace) {
  // Assimp 5.2.5 by itself takes that byte for the end of the header.
  Surface surface = single_triangle();
  surface.vertices[0].x() = double{std::bit_cast<float>(0x3F80000Au)};
  const LoadedMesh loaded = load("mesh.ply", as_binary_ply<float>(surface, false));
  EXPECT_EQ(loaded.mesh->vertex(0).x(), surface.vertices[0].x());
  EXPECT_EQ(loaded.mesh->vertex(2).y(), 1.0);
}

TEST_F(LoadMesh, LargeFilesPassThroughAssimpsBlocks) {
  // Beyond one megabyte in PLY, and 16 in OBJ, assimp reads piece by piece.
  const Surface surface = weld(torus(420));
  for (const int f : {2, 3, 6}) {
    const std::string contents = formats()[f].write(surface);
    if (f == 6) {
      ASSERT_GT(contents.size(), 17u << 20);
    }
    const LoadedMesh loaded = load(formats()[f].file, contents);
    ASSERT_EQ(loaded.mesh->triangle_count(), surface.triangles.size());
    ASSERT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
    for (VertexId v = 0; v < surface.vertices.size(); ++v) {
      ASSERT_LT((loaded.mesh->vertex(v) - surface.vertices[v]).norm(), 1e-6);
    }
  }
}

// Polygons.

const char* const square_off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

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
  // An L of six corners, which a fan from the first would not cover right.
  const LoadedMesh obj = load("mesh.obj",
                              "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\n"
                              "f -6 -5 -4 -3 -2 -1\n");
  EXPECT_EQ(obj.mesh->triangle_count(), 4u);
  EXPECT_DOUBLE_EQ(area_of(*obj.mesh), 3.0);
  for (TriangleId t = 0; t < 4; ++t) EXPECT_EQ(obj.mesh->normal(t), Vec3(0, 0, 1)) << t;
}

TEST_F(LoadMesh, PolygonsOfAnySizeAreReadExceptFromOff) {
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
  EXPECT_CONTAINS(complaint("mesh.off", off + corners + "\n"), "up to 9");
}

TEST_F(LoadMesh, FacesOfFewerThanThreeCornersAreLeftOutWithAWarning) {
  const LoadedMesh loaded =
      load("mesh.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n1 2\n");
  EXPECT_EQ(loaded.mesh->triangle_count(), 1u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "2 faces");
}

// What headers declare.

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
  // A list that nobody asks for, and that assimp would allocate: 32 GB.
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
       {load("mesh.off", std::string(square_off) + "3 0 1 2\n"),
        load("mesh.ply", as_text_ply(single_triangle()) + "3 0 1 2 -7\n"),
        load("mesh.ply", as_binary_ply<float>(single_triangle(), false) + "more")}) {
    ASSERT_EQ(loaded.warnings.size(), 1u);
    EXPECT_CONTAINS(loaded.warnings[0], "more in the file");
  }
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

// Each format by itself.

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
  const LoadedMesh loaded = load("mesh.obj", points + "f 1 2 3\n");
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "2 lines or points");
  EXPECT_CONTAINS(complaint("mesh.obj", points), "no faces");
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), "line 3");
}

TEST_F(LoadMesh, ObjFreeFormSurfacesAreAnError) {
  EXPECT_CONTAINS(complaint("mesh.obj", "v 0 0 0\ncstype bspline\nsurf 0 1 0 1 1\n"), "free-form");
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
  const auto message = [&](const char* from, const char* to) {
    return complaint("mesh.ply", replaced(ply, from, to));
  };
  EXPECT_CONTAINS(message("float x", "quaternion x"), "line 5: unknown type");
  EXPECT_CONTAINS(message("ascii 1.0", "ascii 2.0"), "line 2");
  EXPECT_CONTAINS(message("ascii", "morse"), "line 2");
  EXPECT_CONTAINS(message("comment made", "remark made"), "line 3");
  EXPECT_CONTAINS(message("list uchar", "list float"), "line 10");
  EXPECT_CONTAINS(message("float z", "float height"), "no z");
  EXPECT_CONTAINS(message("vertex_indices", "corners"), "vertex_indices");
  EXPECT_CONTAINS(message("element vertex", "element point"), "no vertices");
  EXPECT_CONTAINS(complaint("mesh.ply", ply.substr(0, ply.find("end_header"))),
                  "within its header");
}

TEST_F(LoadMesh, PlyElementsThatAreNotAskedForArePassedOver) {
  // Assimp 5.2.5 by itself passes over none of them, and reads the faces from their bytes.
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
  const auto message = [&](const char* from, const char* to) {
    return complaint("mesh.stl", replaced(stl, from, to));
  };
  EXPECT_CONTAINS(message("endsolid", "endsolit"), "line 9: expected 'facet'");
  EXPECT_CONTAINS(message("  endloop\n", ""), "line 7: expected 'endloop'");
  EXPECT_CONTAINS(message("    vertex 1 0 0\n", ""), "expected 'vertex', found 'endloop'");
  EXPECT_CONTAINS(message("vertex 1 0 0", "vertex 1 0 0\nvertex 1 1 0"), "more than three corners");
  EXPECT_CONTAINS(message("vertex 1 0 0", "vertex 1 0"), "expected a number, found 'vertex'");
  EXPECT_CONTAINS(message("facet normal 0 0 1", "facet"), "expected 'normal'");
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

// Files.

TEST_F(LoadMesh, WhatIsNotAReadableFileIsAnError) {
  EXPECT_CONTAINS(complaint(folder.path() / "absent.stl"), "no such file");
  EXPECT_CONTAINS(complaint(folder.path()), "directory");
  EXPECT_CONTAINS(complaint("mesh.obj", ""), "empty");
  const fs::path pipe = folder.path() / "pipe.stl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_CONTAINS(complaint(pipe), "not a regular file");
}

TEST_F(LoadMesh, AFileWithoutPermissionIsAnError) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const fs::path path = folder.write("mesh.off", square_off);
  fs::permissions(path, fs::perms::none);
  EXPECT_CONTAINS(complaint(path), "permissions");
}

TEST_F(LoadMesh, AnUnknownExtensionIsAnErrorListingTheKnown) {
  for (const std::string_view name : {"mesh.vtk", "mesh", "stl", "mesh.stl.bak"}) {
    const std::string message = complaint(name, square_off);
    EXPECT_CONTAINS(message, ".stl, .ply, .obj, .off");
  }
}

TEST_F(LoadMesh, ACompressedFileIsAnErrorWhateverItsExtension) {
  for (const std::string_view name : {"mesh.stl", "mesh.obj", "mesh.stl.gz"}) {
    EXPECT_CONTAINS(complaint(name, "\x1f\x8b\x08 and so on"), "unpack");
  }
}

TEST_F(LoadMesh, ContentOfAnotherFormatIsAnErrorNamingIt) {
  EXPECT_CONTAINS(complaint("mesh.stl", as_text_ply(tetrahedron())), ".ply");
  EXPECT_CONTAINS(complaint("mesh.obj", square_off), ".off");
  EXPECT_CONTAINS(complaint("mesh.ply", as_text_stl(tetrahedron())), ".stl");
  EXPECT_CONTAINS(complaint("mesh.off", as_obj(tetrahedron())), "expected 'OFF'");
  EXPECT_CONTAINS(complaint("mesh.obj", "Dear diary,\nnothing today.\n"), "hardly an OBJ file");
}

TEST_F(LoadMesh, SeveralThreadsMayLoadAtOnce) {
  std::vector<fs::path> paths;
  for (const Format& format : formats()) {
    paths.push_back(folder.write(format.name + format.file, format.write(round_torus())));
  }
  std::vector<std::size_t> counts(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t& count : counts) {
    threads.emplace_back([&] {
      for (const fs::path& path : paths) count += load_mesh(path).mesh->triangle_count();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::size_t count : counts) EXPECT_EQ(count, formats().size() * 128u);
}

}  // namespace
}  // namespace keepout
