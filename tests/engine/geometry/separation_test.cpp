// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/separation.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/reference_separation.h"
#include "engine/geometry/tools.h"
#include "keepout/geometry/closest_point.h"
#include "trials.h"

namespace keepout {
namespace {

using test::NamedTool;
using test::reference_separation;
using test::tools_of_each_kind;

Triangle random_triangle(Random& random, double size) {
  Triangle t;
  for (Vec3& corner : t) corner = size * random.uniform() * random.direction();
  return t;
}

/// Returns a needle, a segment or a point.
Triangle hostile_triangle(Random& random, double size) {
  Triangle t = random_triangle(random, size);
  const double tiny = std::pow(10.0, random.uniform(-17.0, -3.0));
  switch (random.below(5)) {
    case 0:
      t[2] = t[1];
      break;
    case 1:
      t[1] = t[2] = t[0];
      break;
    case 2:
      t[2] = 0.5 * (t[0] + t[1]);
      break;
    case 3:
      t[2] = t[1] + tiny * random.direction();
      break;
    default:
      t[2] = 0.3 * t[0] + 0.7 * t[1] + tiny * random.direction();
      break;
  }
  return t;
}

double size_of(const ConvexTool& tool, const Triangle& triangle) {
  double size = tool.radius();
  for (const Vec3& p : tool.points()) size = std::max(size, p.norm());
  for (const Vec3& v : triangle) size = std::max(size, v.norm());
  return size;
}

double reference(const ConvexTool& tool, const Triangle& triangle) {
  return reference_separation(tool.points(), triangle) - tool.radius();
}

/// Checks that the plane proves the distance, and that both points are on their surfaces.
void expect_consistent(const Separation& s, const ConvexTool& tool, const Triangle& triangle,
                       double tolerance) {
  EXPECT_NEAR(s.normal.norm(), 1.0, 1e-14);
  EXPECT_NEAR(separation_along(s.normal, tool, Vec3::Zero(), triangle), s.distance, tolerance);
  EXPECT_LE(closest_point(triangle, s.on_triangle).distance, tolerance);
  // The tool's point, moved inward by the radius, is in the core.
  const Vec3 on_core = s.on_tool() + tool.radius() * s.normal;
  EXPECT_LE(reference_separation(tool.points(), {on_core, on_core, on_core}), tolerance);
}

TEST(Separation, IsThatOfBruteForceInMoreDigits) {
  Random random(1);
  int apart = 0, cores_overlap = 0, shallow = 0;
  for (int i = 0; i < 150; ++i) {
    for (const NamedTool& named : tools_of_each_kind(1.0, random)) {
      SCOPED_TRACE(named.name + " " + std::to_string(i));
      Triangle triangle = random_triangle(random, 2.0);
      const Vec3 off = 1.5 * random.uniform() * random.direction();
      for (Vec3& corner : triangle) corner += off;
      const double expected = reference(named.tool, triangle);
      const Separation s = separation(named.tool, Vec3::Zero(), triangle);
      const double tolerance = 1e-14 * size_of(named.tool, triangle);
      ASSERT_NEAR(s.distance, expected, tolerance);
      expect_consistent(s, named.tool, triangle, 1e-12);
      (expected > 0.0 ? apart : expected > -named.tool.radius() ? shallow : cores_overlap) += 1;
    }
  }
  EXPECT_GT(apart, 80);
  EXPECT_GT(cores_overlap, 50);
  EXPECT_GT(shallow, 50);
}

TEST(Separation, NeedlesSegmentsAndPointsAreWhatTheyAre) {
  Random random(2);
  for (int i = 0; i < 150; ++i) {
    for (const NamedTool& named : tools_of_each_kind(1.0, random)) {
      SCOPED_TRACE(named.name + " " + std::to_string(i));
      Triangle triangle = hostile_triangle(random, 2.0);
      const Vec3 off = random.uniform() * random.direction();
      for (Vec3& corner : triangle) corner += off;
      const Separation s = separation(named.tool, Vec3::Zero(), triangle);
      ASSERT_NEAR(s.distance, reference(named.tool, triangle), 1e-12);
      expect_consistent(s, named.tool, triangle, 1e-11);
    }
  }
}

TEST(Separation, IsRightAllTheWayThroughATouch) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    for (const NamedTool& named : tools_of_each_kind(1.0, random)) {
      const Triangle triangle = random_triangle(random, 2.0);
      const Vec3 off = 1.5 * random.direction();
      // Moves the tool to where the cores touch, and from there in or out by a small random step.
      const ConvexTool core = ConvexTool::hull(named.tool.points());
      const Separation start = separation(core, off, triangle);
      const double step = std::pow(10.0, random.uniform(-18.0, -2.0)) * (i % 2 == 0 ? 1.0 : -1.0);
      const Vec3 position = off - (start.distance + step) * start.normal;
      Triangle relative = triangle;
      for (Vec3& corner : relative) corner -= position;
      const Separation s = separation(named.tool, Vec3::Zero(), relative);
      SCOPED_TRACE(named.name + " " + std::to_string(i));
      ASSERT_NEAR(s.distance, reference(named.tool, relative), 1e-14);
      expect_consistent(s, named.tool, relative, 1e-12);
    }
  }
}

TEST(Separation, ParallelEdgesAndFacesAreNoExceptions) {
  // On a lattice, many edges and faces are parallel or coincide.
  Random random(4);
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  const ConvexTool capsule = ConvexTool::capsule({0, 0, -1}, {0, 0, 1}, 0.5);
  const std::vector<Vec3> square{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}};
  const ConvexTool flat = ConvexTool::hull(square);
  for (int i = 0; i < 400; ++i) {
    Triangle triangle;
    for (Vec3& corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = static_cast<double>(random.below(7)) * 0.5 - 1.5;
      }
    }
    for (const ConvexTool& tool : {box, capsule, flat}) {
      SCOPED_TRACE(i);
      const Separation s = separation(tool, Vec3::Zero(), triangle);
      ASSERT_NEAR(s.distance, reference(tool, triangle), 1e-14);
      expect_consistent(s, tool, triangle, 1e-13);
    }
  }
}

TEST(Separation, OfPointsInOnePlaneIsRight) {
  // All differences of two points are in one plane, so they span no tetrahedron.
  Random random(8);
  const ConvexTool square =
      ConvexTool::hull(std::vector<Vec3>{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    Triangle triangle;
    for (Vec3& corner : triangle) {
      for (int axis = 0; axis < 2; ++axis) {
        corner[axis] = i % 2 == 0 ? random.uniform(-3.0, 3.0)
                                  : static_cast<double>(random.below(13)) * 0.5 - 3.0;
      }
      corner[2] = 0.0;
    }
    const double expected = reference(square, triangle);
    ASSERT_NEAR(separation(square, Vec3::Zero(), triangle).distance, expected, 1e-14) << i;
    apart += expected > 0.0 ? 1 : 0;
  }
  EXPECT_GT(apart, 100);
}

TEST(Separation, ASmallTurnOfParallelEdgesCostsFewDigits) {
  Random random(5);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double angle = std::pow(10.0, random.uniform(-12.0, -1.0));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
    const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)}).rotated(turn);
    Triangle triangle{Vec3(-3, 1, 0), Vec3(3, 1, 0), Vec3(0, 1, 3)};
    const Vec3 off = 0.3 * random.direction();
    for (Vec3& corner : triangle) corner += off;
    const Separation s = separation(box, Vec3::Zero(), triangle);
    worst = std::max(worst, std::abs(s.distance - reference(box, triangle)));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(Separation, ASphereIsAsFarAsItsCentreLessTheRadiusToTheBit) {
  Random random(6);
  for (int i = 0; i < 20'000; ++i) {
    const Triangle triangle =
        i % 2 == 0 ? random_triangle(random, 2.0) : hostile_triangle(random, 2.0);
    const Vec3 position = 2.0 * random.uniform() * random.direction();
    const double radius = random.uniform();
    const ClosestPoint closest = closest_point(triangle, position);
    const Separation s = separation(ConvexTool::sphere(radius), position, triangle);
    ASSERT_EQ(s.distance, closest.distance - radius);
  }
}

TEST(Separation, ACentreOnTheTriangleIsPartedAlongItsNormal) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  const Separation s = separation(ConvexTool::sphere(0.5), {1, 1, 0}, triangle);
  EXPECT_EQ(s.distance, -0.5);
  EXPECT_EQ(s.normal, Vec3(0, 0, 1));
}

TEST(Separation, NoPrecisionIsLostFarFromTheOrigin) {
  const Vec3 far(1e7, -1e7, 1e7);  // exact sums: the corners are small integers
  const Triangle triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  Triangle moved = triangle;
  for (Vec3& corner : moved) corner += far;
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  for (const Vec3& position : {Vec3(1, 1, 4), Vec3(1, 1, 0.5)}) {
    EXPECT_EQ(separation(box, position + far, moved).distance,
              separation(box, position, triangle).distance);
  }
}

TEST(Separation, AHullOfManyPointsIsHandled) {
  Random random(8);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < ConvexTool::most_points; ++i) points.push_back(random.direction());
  const ConvexTool hull = ConvexTool::hull(points);
  for (int i = 0; i < 40; ++i) {
    const Triangle triangle = random_triangle(random, 2.0);
    const Vec3 position = random.uniform() * random.direction();
    const Separation s = separation(hull, position, triangle);
    // Brute force takes time to the fourth power of the number of points. This test checks
    // properties of the answer instead.
    EXPECT_NEAR(separation_along(s.normal, hull, position, triangle), s.distance, 1e-14);
    const Vec3 way = -s.distance * s.normal;
    EXPECT_NEAR(separation(hull, position + way, triangle).distance, 0.0, 1e-13);
    for (int k = 0; k < 1000; ++k) {
      EXPECT_LE(separation_along(random.direction(), hull, position, triangle), s.distance + 1e-14);
    }
  }
}

TEST(Separation, ItsNormalIsOfUnitLengthHoweverThinATriangleIs) {
  Random random(9);
  for (int i = 0; i < test::trials(2000); ++i) {
    const auto thin = [&] { return std::pow(10.0, random.uniform(-320.0, -140.0)); };
    Triangle t = random_triangle(random, 2.0);
    for (Vec3& corner : t) {
      for (double& x : corner) {
        if (random.below(2) == 0) x = thin();
      }
    }
    for (const NamedTool& named : tools_of_each_kind(2.0, random)) {
      const Separation found = separation(named.tool, {0, 0, i % 2 == 0 ? thin() : 1.0}, t);
      ASSERT_NEAR(found.normal.norm(), 1.0, 1e-14) << named.name << ' ' << i;
      ASSERT_TRUE(std::isfinite(found.distance) && found.on_triangle.allFinite()) << named.name;
    }
  }
}

TEST(Separation, NoDistanceIsToldThatNoPlaneProvesHoweverMixedTheLengths) {
  Random random(10);
  const auto coordinate = [&] {
    constexpr double sizes[] = {0.0, 1e-9, 1e-3, 1.0, 7.0, 1e3, 1e9, -1.0};
    const double size = sizes[random.below(8)];
    return random.below(2) == 0 ? size : size * random.uniform();
  };
  const auto place = [&] { return Vec3(coordinate(), coordinate(), coordinate()); };
  for (int i = 0; i < test::trials(20'000); ++i) {
    std::vector<Vec3> points(2 + random.below(4));
    for (Vec3& p : points) p = place();
    const ConvexTool tool = ConvexTool::hull(points);
    if (tool.points().size() == 1) continue;  // the exact kernel serves balls
    const Triangle t{place(), place(), place()};
    const Vec3 position = place();
    double size =
        position.norm() + tool.bounding_ball().center.norm() + tool.bounding_ball().radius;
    for (const Vec3& corner : t) size = std::max(size, corner.norm());
    const Separation found = separation(tool, position, t);
    ASSERT_LE(found.distance, separation_along(found.normal, tool, position, t) + 1e-14 * size)
        << i;
  }
}

}  // namespace
}  // namespace keepout
