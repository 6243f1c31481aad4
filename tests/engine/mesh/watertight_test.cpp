// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/doctor.h"

namespace keepout {
namespace {

TEST(Watertight, IsWhatTheDoctorFinds) {
  std::size_t watertight = 0;
  for (const Shape& shape : shapes()) {
    const Mesh mesh(shape.make());
    EXPECT_EQ(is_watertight(mesh), examine(mesh).is_watertight()) << shape.name;
    watertight += is_watertight(mesh);
  }
  EXPECT_GT(watertight, 5u);
  EXPECT_LT(watertight, shapes().size());
}

TEST(Watertight, OneTriangleMoreLessOrTheOtherWayRoundIsNot) {
  const Surface cube = make_shape("cube");
  EXPECT_TRUE(is_watertight(Mesh(cube)));
  Surface less = cube;
  less.triangles.pop_back();
  EXPECT_FALSE(is_watertight(Mesh(less)));
  Surface more = cube;
  more.triangles.push_back(cube.triangles.front());
  EXPECT_FALSE(is_watertight(Mesh(more)));
  Surface turned = cube;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_FALSE(is_watertight(Mesh(turned)));
}

}  // namespace
}  // namespace keepout
