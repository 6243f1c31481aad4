// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

TEST(Example04, TheWholeShaftEndsOutsideOfTheMeshByTheMargin) {
  const TemporaryFolder folder;
  write_binary_stl(folder.path() / "sphere.stl", make_sphere(3.0));
  const std::string line = std::string("'") + KEEPOUT_CONVEX_TOOL_EXAMPLE + "' '" +
                           (folder.path() / "sphere.stl").string() + "'";
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
  for (int i = 0; i <= 100; ++i) {
    const Vec3 on_the_axis = tip + 0.01 * i * Vec3(8.5, 0, 8.5);
    EXPECT_GT(on_the_axis.norm(), 50.0 - 0.1 + 1.5 + 0.2 - 1e-6);
  }
}

}  // namespace
}  // namespace keepout
