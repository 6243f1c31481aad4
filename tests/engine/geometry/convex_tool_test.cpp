// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include <cmath>

#include "engine/geometry/tools.h"
#include "keepout/error.h"
#include "trials.h"

namespace keepout {
namespace {

const Box unit_box{Vec3(-1, -1, -1), Vec3(1, 1, 1)};

TEST(ConvexTool, OneRepresentationServesSphereCapsuleBoxAndHull) {
  EXPECT_EQ(ConvexTool::sphere(2.0).points().size(), 1u);
  EXPECT_EQ(ConvexTool::capsule({0, 0, 0}, {0, 0, 5}, 1.0).points().size(), 2u);
  EXPECT_EQ(ConvexTool::capsule({0, 0, 5}, {0, 0, 5}, 1.0).points().size(), 1u);
  EXPECT_EQ(ConvexTool::box(unit_box).points().size(), 8u);
  const std::vector<Vec3> twice{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
  EXPECT_EQ(ConvexTool::hull(twice).points().size(), 3u);
}

TEST(ConvexTool, ABoxHasThreeFaceNormals) {
  const ConvexTool box = ConvexTool::box({Vec3(-1, -2, -3), Vec3(1, 2, 3)});
  EXPECT_EQ(box.face_normals().size(), 3u);
  EXPECT_GE(box.edge_directions().size(), 3u);
  EXPECT_LE(box.edge_directions().size(), 9u);  // with the diagonals of its faces
}

TEST(ConvexTool, ItsBallHoldsIt) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
      const Ball& ball = named.tool.bounding_ball();
      for (const Vec3& p : named.tool.points()) {
        EXPECT_LE((p - ball.center).norm() + named.tool.radius(), ball.radius) << named.name;
      }
    }
  }
}

TEST(ConvexTool, SupportIsTheFarthestPoint) {
  const ConvexTool box = ConvexTool::box(unit_box);
  EXPECT_EQ(box.support({1, 2, 3}), Vec3(1, 1, 1));
  EXPECT_EQ(box.support({-1, 2, -3}), Vec3(-1, 1, -1));
}

TEST(ConvexTool, WhatIsNoToolIsRefused) {
  const double nan = std::nan("");
  for (const double radius : {-1.0, nan, test::infinity}) {
    EXPECT_THROW(ConvexTool::sphere(radius), Error);
  }
  EXPECT_THROW(ConvexTool::capsule({0, nan, 0}, {0, 0, 1}, 1.0), Error);
  EXPECT_THROW(ConvexTool::hull({}), Error);
  EXPECT_THROW(ConvexTool::hull(std::vector<Vec3>{Vec3(test::infinity, 0, 0)}), Error);
  std::vector<Vec3> many;
  for (int i = 0; i < 64; ++i) many.emplace_back(i, i * i, 1.0);
  EXPECT_NO_THROW(ConvexTool::hull(many));
  many.emplace_back(64, 64 * 64, 1.0);
  EXPECT_THROW(ConvexTool::hull(many), Error);
}

TEST(ConvexTool, DirectionsAreOfUnitLengthAndPointsTooNearForThatAreRefused) {
  for (int exponent = -320; exponent <= 30; ++exponent) {
    const double size = std::pow(10.0, exponent);
    const std::vector<Vec3> points{Vec3::Zero(), size * Vec3(1, 0, 0), size * Vec3(0.3, 0.9, 0)};
    if (exponent < -29) {
      EXPECT_THROW(ConvexTool::hull(points), Error) << exponent;
      continue;
    }
    const ConvexTool tool = ConvexTool::hull(points);
    EXPECT_EQ(tool.face_normals().size(), 1u) << exponent;
    EXPECT_EQ(tool.edge_directions().size(), 3u) << exponent;
    for (const Vec3& n : tool.face_normals()) EXPECT_NEAR(n.norm(), 1.0, 1e-15) << exponent;
    for (const Vec3& n : tool.edge_directions()) EXPECT_NEAR(n.norm(), 1.0, 1e-15) << exponent;
  }
}

TEST(ConvexTool, OnlyARotationTurnsIt) {
  const ConvexTool box = ConvexTool::box(unit_box);
  EXPECT_THROW(box.rotated(2.0 * Eigen::Matrix3d::Identity()), Error);
  EXPECT_THROW(box.rotated(-Eigen::Matrix3d::Identity()), Error);
  EXPECT_THROW(box.rotated(Eigen::Matrix3d::Constant(std::nan(""))), Error);
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(ConvexTool::capsule({0, 0, 0}, {1, 0, 0}, 1.0).rotated(quarter).points()[1],
            Vec3(0, 1, 0));
}

}  // namespace
}  // namespace keepout
