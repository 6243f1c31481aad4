// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_stl.h"

#include <sys/stat.h>

#include <cstring>
#include <limits>
#include <optional>

#include "keepout/mesh/load_mesh.h"
#include "mesh_file.h"
#include "meshes.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

/// An independent reader without welding: no reader is tested with its own idea of the format.
Surface unwelded(const fs::path& path) {
  const std::string bytes = contents_of(path);
  Surface surface;
  for (std::size_t record = 84; record < bytes.size(); record += 50) {
    const auto first = static_cast<VertexId>(surface.vertices.size());
    float c[9];
    std::memcpy(c, bytes.data() + record + 12, sizeof c);
    for (int i = 0; i < 9; i += 3) surface.vertices.emplace_back(c[i], c[i + 1], c[i + 2]);
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  return surface;
}

std::optional<Surface> read(const fs::path& path, unsigned threads = 0) {
  return read_binary_stl(MeshSource(path), threads);
}

std::string message_of_reading(const fs::path& path, unsigned threads = 0) {
  return error_of([&] { read(path, threads); });
}

class BinaryStl : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path file = folder.path() / "mesh.stl";
};

TEST_F(BinaryStl, GivesBackTheTrianglesThatWereWritten) {
  const Surface written = torus(120);  // 28,800 triangles: more than are read at once
  write_binary_stl(file, written);
  const Surface surface = read(file).value();
  ASSERT_EQ(surface.triangles.size(), written.triangles.size());
  ASSERT_EQ(surface.vertices.size(), written.vertices.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& expected = written.vertices[written.triangles[t][i]];
      const Vec3& actual = surface.vertices[surface.triangles[t][i]];
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(actual[axis], double{static_cast<float>(expected[axis])}) << t;
      }
    }
  }
}

TEST_F(BinaryStl, APipeOrDeviceIsNotReplacedByAFile) {
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_THROW(write_binary_stl(file, single_triangle()), Error);
  EXPECT_TRUE(fs::is_fifo(file));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST_F(BinaryStl, WritesTriangleByTriangleTheSameAsAtOnce) {
  write_binary_stl(file, torus(5));
  const std::string from_surface = contents_of(file);
  const Mesh mesh(torus(5));
  write_binary_stl(file, mesh.triangle_count(),
                   [&](std::uint64_t t) { return mesh.triangle(static_cast<TriangleId>(t)); });
  EXPECT_EQ(contents_of(file), from_surface);
}

TEST_F(BinaryStl, WritesTheNormalOfEachTriangle) {
  write_binary_stl(file, single_triangle());
  float normal[3];
  std::memcpy(normal, contents_of(file).data() + 84, sizeof normal);
  EXPECT_EQ(normal[0], 0.0F);
  EXPECT_EQ(normal[1], 0.0F);
  EXPECT_EQ(normal[2], 1.0F);
}

TEST_F(BinaryStl, IsToldByItsLengthEvenIfItBeginsWithSolid) {
  write_binary_stl(file, tetrahedron());
  std::string bytes = contents_of(file);
  bytes.replace(0, 5, "solid");
  folder.write("mesh.stl", bytes);
  EXPECT_EQ(read(file).value().triangles.size(), 4u);
}

TEST_F(BinaryStl, OfAnyOtherLengthIsNone) {
  write_binary_stl(file, tetrahedron());
  const std::string bytes = contents_of(file);
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    folder.write("mesh.stl", bytes.substr(0, length));
    ASSERT_FALSE(read(file).has_value()) << length;
    ASSERT_THROW(load_mesh(file), Error) << length;
  }
  folder.write("mesh.stl", bytes + '\0');
  EXPECT_FALSE(read(file).has_value());
  EXPECT_THROW(load_mesh(file), Error);
}

TEST_F(BinaryStl, WhereThereIsNoFileOrNothingInItIsAnError) {
  EXPECT_THROW(read(folder.path() / "absent.stl"), Error);
  EXPECT_THROW(read(folder.path()), Error);
  folder.write("mesh.stl", "");
  EXPECT_THROW(read(file), Error);
}

TEST_F(BinaryStl, WithoutTrianglesIsAnError) {
  folder.write("mesh.stl", std::string(84, '\0'));
  EXPECT_CONTAINS(message_of_reading(file), "no triangles");
}

TEST_F(BinaryStl, ACoordinateThatIsNotFiniteIsAnErrorNamingFileAndTriangle) {
  write_binary_stl(file, tetrahedron());
  const std::string good = contents_of(file);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    std::string bytes = good;
    std::memcpy(bytes.data() + 84 + 2 * 50 + 12 + 4, &bad, sizeof bad);
    folder.write("mesh.stl", bytes);
    const std::string message = message_of_reading(file);
    EXPECT_CONTAINS(message, file.string());
    EXPECT_CONTAINS(message, "triangle 2");
  }
}

TEST_F(BinaryStl, ANormalThatIsNotANumberIsNoMatter) {
  write_binary_stl(file, tetrahedron());
  std::string bytes = contents_of(file);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + 84, &bad, sizeof bad);
  folder.write("mesh.stl", bytes);
  EXPECT_EQ(read(file).value().triangles.size(), 4u);
}

TEST_F(BinaryStl, WritingReplacesAFileAndLeavesNothingElse) {
  folder.write("mesh.stl", "what was there before");
  write_binary_stl(file, tetrahedron());
  EXPECT_EQ(read(file).value().triangles.size(), 4u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST_F(BinaryStl, WhatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  EXPECT_THROW(write_binary_stl(folder.path() / "no" / "such.stl", tetrahedron()), Error);
  Surface huge = tetrahedron();
  huge.vertices[1].x() = 1e39;  // beyond single precision
  EXPECT_THROW(write_binary_stl(file, huge), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BinaryStl, MoreTrianglesThanTheFormatCountsAreAnErrorAndLeaveNothing) {
  const auto never = [](std::uint64_t) -> Triangle { throw std::logic_error("asked for"); };
  EXPECT_THROW(write_binary_stl(file, std::uint64_t{1} << 32, never), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BinaryStl, ATriangleThatThrowsLeavesNothing) {
  const auto fails = [](std::uint64_t t) -> Triangle {
    if (t == 1) throw std::logic_error("no such triangle");
    return {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  };
  EXPECT_THROW(write_binary_stl(file, 2, fails), std::logic_error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BinaryStl, WritingOverAFolderIsAnErrorAndLeavesNothingElse) {
  fs::create_directories(file / "occupied");
  EXPECT_THROW(write_binary_stl(file, tetrahedron()), Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

// Reading and welding in one pass.

bool are_equal(const Surface& one, const Surface& other) {
  return one.triangles == other.triangles && one.vertices.size() == other.vertices.size() &&
         std::memcmp(one.vertices.data(), other.vertices.data(),
                     one.vertices.size() * sizeof(Vec3)) == 0;
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceIsTheSameOnAnyNumberOfThreads) {
  // Several blocks. They share vertices with near blocks, or, if shuffled, with any block.
  for (const Surface& surface : {torus(160), shuffled(torus(160), 1), single_triangle()}) {
    write_binary_stl(file, surface);
    const Surface expected = weld(unwelded(file), 1);
    for (const unsigned threads : {0u, 1u, 2u, 3u, 8u}) {
      ASSERT_TRUE(are_equal(read(file, threads).value(), expected)) << threads;
      ASSERT_TRUE(are_equal(weld(unwelded(file), threads), expected)) << threads;
    }
  }
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceHoldsMoreVerticesThanAClosedSurfaceHas) {
  Surface apart;
  for (VertexId t = 0; t < 40'000; ++t) {
    for (int i = 0; i < 3; ++i) apart.vertices.emplace_back(t, i, 0.5 * i * i - i);
    apart.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  write_binary_stl(file, apart);
  EXPECT_TRUE(are_equal(read(file, 2).value(), apart));
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceTakesMinusZeroForZero) {
  Surface surface = single_triangle();
  surface.vertices.emplace_back(-0.0, 0.0, -0.0);
  surface.triangles.push_back({3, 2, 1});
  write_binary_stl(file, surface);
  EXPECT_TRUE(are_equal(read(file).value(), weld(surface)));
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceHasTheSameErrorsOnAnyNumberOfThreads) {
  const auto expect_same = [&] {
    const std::string expected = message_of_reading(file, 1);
    EXPECT_NE(expected, "no error");
    for (const unsigned threads : {2u, 8u}) EXPECT_EQ(message_of_reading(file, threads), expected);
  };
  expect_same();  // there is no file
  folder.write("mesh.stl", std::string(84, '\0'));
  expect_same();
  write_binary_stl(file, torus(160));
  const std::string good = contents_of(file);
  folder.write("mesh.stl", good.substr(0, good.size() - 1));
  for (const unsigned threads : {1u, 2u, 8u}) EXPECT_FALSE(read(file, threads).has_value());
  // The error names the first of several bad triangles, in any block.
  std::string bad = good;
  for (const std::size_t triangle : {51'000u, 40'003u, 40'001u, 33'000u, 16'383u}) {
    const float value = std::numeric_limits<float>::infinity();
    std::memcpy(bad.data() + 84 + triangle * 50 + 12, &value, sizeof value);
    folder.write("mesh.stl", bad);
    expect_same();
    EXPECT_CONTAINS(message_of_reading(file, 2), "triangle " + std::to_string(triangle) + " ");
  }
}

TEST_F(BinaryStl, AVertexThatDoesNotExistIsNotWritten) {
  Surface surface = single_triangle();
  surface.triangles.push_back({0, 1, 3});
  EXPECT_CONTAINS(error_of([&] { write_binary_stl(file, surface); }), "triangle 1 names vertex 3");
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace keepout
