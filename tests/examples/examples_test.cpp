// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The examples do what they say: on a sphere, whose top they come down upon.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

/// What an example prints of the sphere, in one line.
std::string output_of(const std::string& example) {
  const TemporaryFolder folder;
  const auto mesh = folder.path() / "sphere.stl";
  write_binary_stl(mesh, make_sphere(3.0));
  FILE* pipe = ::popen(("'" + example + "' '" + mesh.string() + "'").c_str(), "r");
  if (pipe == nullptr) return {};
  char line[256] = "";
  std::string text;
  while (std::fgets(line, sizeof line, pipe) != nullptr) text += line;
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

/// How often the tip was held back, and where it ended.
struct Ending {
  int held = 0;
  Vec3 tip = Vec3::Zero();
};

Ending ending_of(const std::string& example) {
  Ending ending;
  const std::string text = output_of(example);
  EXPECT_EQ(std::sscanf(text.c_str(), "held back in %d of 2000 cycles, ends at %lf %lf %lf",
                        &ending.held, &ending.tip.x(), &ending.tip.y(), &ending.tip.z()),
            4)
      << text;
  return ending;
}

// The polyhedron lies up to 0.1 within the sphere.
constexpr double radius = 50.0 - 0.1;

TEST(Example01, EndsOutsideOfTheMeshByTheMargin) {
  const Ending ending = ending_of(KEEPOUT_EXAMPLE);
  EXPECT_GT(ending.held, 100);
  EXPECT_GT(ending.tip.norm(), radius + 0.5);
}

TEST(Example03, AnOwnIndexKeepsTheTipOutAsBruteForceDoes) {
  int held = 0, cycles = 0, different = 0;
  const std::string text = output_of(KEEPOUT_EXAMPLE_OWN_INDEX);
  ASSERT_EQ(std::sscanf(text.c_str(), "held back in %d of %d cycles, %d unlike", &held, &cycles,
                        &different),
            3)
      << text;
  EXPECT_GT(held, 100);
  EXPECT_LT(held, cycles);
  EXPECT_EQ(different, 0);
}

TEST(Example04, TheWholeShaftEndsOutsideOfTheMeshByTheMargin) {
  const Ending ending = ending_of(KEEPOUT_EXAMPLE_CONVEX_TOOL);
  EXPECT_GT(ending.held, 100);
  for (int i = 0; i <= 100; ++i) {
    const Vec3 on_the_axis = ending.tip + 0.01 * i * Vec3(8.5, 0, 8.5);
    EXPECT_GT(on_the_axis.norm(), radius + 1.5 + 0.2 - 1e-6);
  }
}

#ifdef KEEPOUT_EXAMPLE_OMPL
TEST(Example07, PlansAroundTheSphere) {
  int motions = 0;
  double length = 0.0;
  const std::string text = output_of(KEEPOUT_EXAMPLE_OMPL);
  ASSERT_EQ(std::sscanf(text.c_str(), "a path of %d proven motions, %lf long", &motions, &length),
            2)
      << text;
  EXPECT_GE(motions, 2);
  EXPECT_GT(length, 120.0);  // straight on would be 120
}
#endif

}  // namespace
}  // namespace keepout
