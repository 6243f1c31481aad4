// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The examples do what they say: on a sphere, whose top they come down upon.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

TEST(Example01, EndsOutsideOfTheMeshByTheMargin) {
  const TemporaryFolder folder;
  write_binary_stl(folder.path() / "sphere.stl", make_sphere(3.0));
  const std::string line =
      std::string("'") + KEEPOUT_EXAMPLE + "' '" + (folder.path() / "sphere.stl").string() + "'";
  FILE* pipe = ::popen(line.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  int held = 0;
  Vec3 tip;
  const int read = std::fscanf(pipe, "held back in %d of 2000 cycles, ends at %lf %lf %lf", &held,
                               &tip.x(), &tip.y(), &tip.z());
  EXPECT_EQ(::pclose(pipe), 0);
  ASSERT_EQ(read, 4);
  EXPECT_GT(held, 100);
  // The polyhedron lies up to 0.1 within the sphere of radius 50.
  EXPECT_GT(tip.norm(), 50.0 + 0.5 - 0.1);
}

TEST(Example03, AnOwnIndexKeepsTheTipOutAsBruteForceDoes) {
  const TemporaryFolder folder;
  write_binary_stl(folder.path() / "sphere.stl", make_sphere(3.0));
  const std::string line = std::string("'") + KEEPOUT_EXAMPLE_OWN_INDEX + "' '" +
                           (folder.path() / "sphere.stl").string() + "'";
  FILE* pipe = ::popen(line.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  int held = 0, cycles = 0, different = 0;
  const int read =
      std::fscanf(pipe, "held back in %d of %d cycles, %d unlike", &held, &cycles, &different);
  EXPECT_EQ(::pclose(pipe), 0);
  ASSERT_EQ(read, 3);
  EXPECT_GT(held, 100);
  EXPECT_LT(held, cycles);
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace keepout
