// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/binary_stl.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <sstream>

#include "keepout/error.h"
#include "keepout/mesh/mesh.h"
#include "small_surfaces.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string message_of_reading(const fs::path& path) {
  try {
    read_binary_stl(path);
    return "no error";
  } catch (const Error& error) {
    return error.what();
  }
}

class BinaryStl : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path file = folder.path() / "mesh.stl";
};

TEST_F(BinaryStl, GivesBackTheTrianglesThatWereWrittenUnwelded) {
  const Surface written = torus(120);  // 28,800 triangles: more than are read at once
  write_binary_stl(file, written);
  const Surface read = read_binary_stl(file);
  ASSERT_EQ(read.triangles.size(), written.triangles.size());
  ASSERT_EQ(read.vertices.size(), 3 * written.triangles.size());
  for (std::size_t t = 0; t < read.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& expected = written.vertices[written.triangles[t][i]];
      const Vec3& actual = read.vertices[read.triangles[t][i]];
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(actual[axis], double{static_cast<float>(expected[axis])}) << t;
      }
    }
  }
}

TEST_F(BinaryStl, WritesAMeshAsItsSurface) {
  write_binary_stl(file, torus(5));
  const std::string from_surface = bytes_of(file);
  write_binary_stl(file, Mesh(torus(5)));
  EXPECT_EQ(bytes_of(file), from_surface);
}

TEST_F(BinaryStl, WritesTheNormalOfEachTriangle) {
  write_binary_stl(file, single_triangle());
  float normal[3];
  std::memcpy(normal, bytes_of(file).data() + 84, sizeof normal);
  EXPECT_EQ(normal[0], 0.0F);
  EXPECT_EQ(normal[1], 0.0F);
  EXPECT_EQ(normal[2], 1.0F);
}

TEST_F(BinaryStl, IsToldByItsLengthEvenIfItBeginsWithSolid) {
  write_binary_stl(file, tetrahedron());
  std::string bytes = bytes_of(file);
  bytes.replace(0, 5, "solid");
  folder.write("mesh.stl", bytes);
  EXPECT_TRUE(is_binary_stl(file));
  EXPECT_EQ(read_binary_stl(file).triangles.size(), 4u);
}

TEST_F(BinaryStl, OfAnyOtherLengthIsNone) {
  write_binary_stl(file, tetrahedron());
  const std::string bytes = bytes_of(file);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    folder.write("mesh.stl", bytes.substr(0, length));
    ASSERT_FALSE(is_binary_stl(file)) << length;
    ASSERT_THROW(read_binary_stl(file), Error) << length;
  }
  folder.write("mesh.stl", bytes + '\0');
  EXPECT_FALSE(is_binary_stl(file));
  EXPECT_THROW(read_binary_stl(file), Error);
}

TEST_F(BinaryStl, WhereThereIsNoFileThereIsNone) {
  EXPECT_FALSE(is_binary_stl(folder.path() / "absent.stl"));
  EXPECT_FALSE(is_binary_stl(folder.path()));
  EXPECT_THROW(read_binary_stl(folder.path() / "absent.stl"), Error);
  EXPECT_THROW(read_binary_stl(folder.path()), Error);
}

TEST_F(BinaryStl, WithoutTrianglesIsAnError) {
  folder.write("mesh.stl", std::string(84, '\0'));
  EXPECT_TRUE(is_binary_stl(file));
  EXPECT_NE(message_of_reading(file).find("no triangles"), std::string::npos);
}

TEST_F(BinaryStl, ACoordinateThatIsNotFiniteIsAnErrorNamingFileAndTriangle) {
  write_binary_stl(file, tetrahedron());
  const std::string good = bytes_of(file);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    std::string bytes = good;
    std::memcpy(bytes.data() + 84 + 2 * 50 + 12 + 4, &bad, sizeof bad);
    folder.write("mesh.stl", bytes);
    const std::string message = message_of_reading(file);
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_NE(message.find("triangle 2"), std::string::npos) << message;
  }
}

TEST_F(BinaryStl, ANormalThatIsNotANumberIsNoMatter) {
  write_binary_stl(file, tetrahedron());
  std::string bytes = bytes_of(file);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + 84, &bad, sizeof bad);
  folder.write("mesh.stl", bytes);
  EXPECT_EQ(read_binary_stl(file).triangles.size(), 4u);
}

TEST_F(BinaryStl, WritingReplacesAFileAndLeavesNothingElse) {
  folder.write("mesh.stl", "what was there before");
  write_binary_stl(file, tetrahedron());
  EXPECT_TRUE(is_binary_stl(file));
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
  EXPECT_THROW(BinaryStlWriter(file, std::uint64_t{1} << 32), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BinaryStl, AWriterThatIsNotCommittedLeavesNothing) {
  { BinaryStlWriter(file, 1).write({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}); }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BinaryStl, WritingOverAFolderIsAnErrorAndLeavesNothingElse) {
  fs::create_directories(file / "occupied");
  EXPECT_THROW(write_binary_stl(file, tetrahedron()), Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

// Read and welded at once.

bool are_equal(const Surface& one, const Surface& other) {
  return one.triangles == other.triangles && one.vertices.size() == other.vertices.size() &&
         std::memcmp(one.vertices.data(), other.vertices.data(),
                     one.vertices.size() * sizeof(Vec3)) == 0;
}

std::string message_of_welding(const fs::path& path, unsigned threads) {
  try {
    read_welded_stl(path, threads);
    return "no error";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceIsTheSameOnAnyNumberOfThreads) {
  // Several blocks, whose vertices are shared with near ones, or with any.
  for (const Surface& surface : {torus(160), shuffled(torus(160), 1), single_triangle()}) {
    write_binary_stl(file, surface);
    const Surface expected = weld(read_binary_stl(file), 1);
    for (const unsigned threads : {0u, 1u, 2u, 3u, 8u}) {
      ASSERT_TRUE(are_equal(read_welded_stl(file, threads), expected)) << threads;
      ASSERT_TRUE(are_equal(weld(read_binary_stl(file), threads), expected)) << threads;
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
  const Surface read = read_welded_stl(file, 2);
  EXPECT_TRUE(are_equal(read, apart));
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceTakesMinusZeroForZero) {
  Surface surface = single_triangle();
  surface.vertices.emplace_back(-0.0, 0.0, -0.0);
  surface.triangles.push_back({3, 2, 1});
  write_binary_stl(file, surface);
  EXPECT_TRUE(are_equal(read_welded_stl(file), weld(surface)));
}

TEST_F(BinaryStl, ReadAndWeldedAtOnceHasTheErrorsOfReading) {
  const auto expect_same = [&] {
    const std::string expected = message_of_reading(file);
    EXPECT_NE(expected, "no error");
    for (const unsigned threads : {1u, 2u, 8u})
      EXPECT_EQ(message_of_welding(file, threads), expected);
  };
  expect_same();  // there is no file
  folder.write("mesh.stl", std::string(84, '\0'));
  expect_same();
  write_binary_stl(file, torus(160));
  const std::string good = bytes_of(file);
  folder.write("mesh.stl", good.substr(0, good.size() - 1));
  expect_same();
  // Of several that are bad it is the first, in whichever block.
  std::string bad = good;
  for (const std::size_t triangle : {51'000u, 40'003u, 40'001u, 33'000u, 16'383u}) {
    const float value = std::numeric_limits<float>::infinity();
    std::memcpy(bad.data() + 84 + triangle * 50 + 12, &value, sizeof value);
    folder.write("mesh.stl", bad);
    expect_same();
    EXPECT_NE(message_of_welding(file, 2).find("triangle " + std::to_string(triangle) + " "),
              std::string::npos);
  }
}

}  // namespace
}  // namespace keepout
