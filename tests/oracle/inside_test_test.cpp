// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/inside_test.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/resample_mesh.h"
#include "meshes.h"

namespace keepout::oracle {
namespace {

InsideTest test_of(const Surface& surface) {
  return InsideTest(std::make_shared<const TriangleTree>(mesh_of(surface)));
}

/// Returns the winding number of the surface around the point, from the sum of the triangles' solid
/// angles. (van Oosterom and Strackee, "The solid angle of a plane triangle", 1983.)
double winding_number(const Surface& surface, const Vec3& point) {
  double sum = 0.0;
  for (const Corners& corners : surface.triangles) {
    const Vec3 a = surface.vertices[corners[0]] - point;
    const Vec3 b = surface.vertices[corners[1]] - point;
    const Vec3 c = surface.vertices[corners[2]] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

TEST(InsideTest, AgreesWithTheSolidAngleOnEverySolid) {
  for (const Shape& shape : shapes()) {
    if (shape.kind != ShapeKind::solid) continue;
    SCOPED_TRACE(shape.name);
    const Surface surface = shape.make();
    const InsideTest test = test_of(surface);
    ASSERT_TRUE(test.closed());
    const Mesh mesh(surface);
    Random random(20261120);
    std::vector<Vec3> points = random_points(mesh, 200, random);
    for (const double offset : {-0.3, 0.3}) {
      for (const Vec3& p : surface_points(mesh, 20, offset, random)) points.push_back(p);
    }
    for (const Vec3& p : points) {
      const double winding = std::abs(winding_number(surface, p));
      ASSERT_LT(std::abs(winding - std::round(winding)), 1e-3);
      ASSERT_EQ(test.inside(p), std::round(winding) == 1.0) << p.transpose();
    }
  }
}

TEST(InsideTest, KnowsTheCubeTheSphereAndTheGear) {
  const InsideTest cube = test_of(make_shape("cube"));
  const InsideTest far_cube = test_of(make_shape("far_cube"));
  const InsideTest sphere = test_of(make_shape("sphere"));
  const InsideTest gear = test_of(make_shape("gear"));
  const Surface far_surface = make_shape("far_cube");
  const Vec3 middle = Mesh(far_surface).bounds().center();
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-60, 60));
    ASSERT_EQ(cube.inside(p), p.lpNorm<Eigen::Infinity>() < 50.0);
    ASSERT_EQ(far_cube.inside(middle + p), p.lpNorm<Eigen::Infinity>() < 50.0);
    if (p.norm() < 49.9 || p.norm() > 50.0) {
      ASSERT_EQ(sphere.inside(p), p.norm() < 49.9);
    }
  }
  EXPECT_EQ(gear.inside({0, 0, 0}), false) << "in the bore";
  EXPECT_EQ(gear.inside({0, 0, 11}), false);
  EXPECT_EQ(gear.inside({60, 0, 0}), false);
  EXPECT_EQ(gear.inside({30, 1, 5}), true);
  EXPECT_EQ(gear.inside({30, 1, 10.5}), false);
}

TEST(InsideTest, OfAPointInLineWithVerticesAndEdgesIsRight) {
  const InsideTest cube = test_of(make_shape("cube"));  // a regular grid of vertices 5 apart
  for (const double x : {-60.0, -51.0, -50.1, -45.0, 0.5, 5.0, 49.9, 50.1, 55.0}) {
    for (int y = -60; y <= 60; y += 5) {
      for (int z = -45; z < 50; z += 5) {
        if (std::abs(y) == 50) continue;
        ASSERT_EQ(cube.inside(Vec3(x, y, z)), std::abs(x) < 50 && std::abs(y) < 50);
      }
    }
  }
}

TEST(InsideTest, OnTheSurfaceIsNotInside) {
  const Surface surface = make_shape("cube");
  const InsideTest cube = test_of(surface);
  for (const Vec3& v : surface.vertices) ASSERT_EQ(cube.inside(v), false);
  EXPECT_EQ(cube.inside({50, 0.3, 0.4}), false);
  EXPECT_EQ(cube.inside({std::nextafter(50.0, 0.0), 0.3, 0.4}), true);
  EXPECT_EQ(cube.inside({std::nextafter(50.0, 60.0), 0.3, 0.4}), false);
}

TEST(InsideTest, SaysNothingOfASurfaceThatIsNotClosed) {
  for (const Shape& shape : shapes()) {
    if (shape.kind != ShapeKind::sheet) continue;
    EXPECT_EQ(test_of(shape.make()).inside({0, 0, 0}), std::nullopt) << shape.name;
  }
  EXPECT_EQ(test_of(make_shape("non_manifold")).inside({0, 0, 0}), std::nullopt);
}

TEST(InsideTest, NeedsNeitherAWeldNorAWindingNorTrianglesWithAnArea) {
  Surface loose = flipped(unwelded(tetrahedron()));
  std::swap(loose.triangles[0][0], loose.triangles[0][1]);
  loose.triangles.push_back({0, 1, 1});
  loose.triangles.push_back({2, 2, 2});
  const InsideTest test = test_of(loose);
  EXPECT_EQ(test.inside({0.1, 0.1, 0.1}), true);
  EXPECT_EQ(test.inside({0.4, 0.4, 0.4}), false);
}

TEST(InsideTest, CountsWhatIsEnclosedTwiceAsOutside) {
  const Surface nested = together(make_cube(50), scaled(make_cube(50), 10));
  const InsideTest test = test_of(nested);
  EXPECT_EQ(test.inside({20, 20, 20}), true);
  EXPECT_EQ(test.inside({1, 1, 1}), false);
}

TEST(VolumeSign, IsThatOfTheUnitVectorsAndExactOneStepOffAPlane) {
  const Vec3 zero = Vec3::Zero();
  EXPECT_EQ(volume_sign(zero, Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()), 1);
  EXPECT_EQ(volume_sign(zero, Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitZ()), -1);
  Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    // The points are in the plane x + y + z = 12, on a fine grid on which sums are exact.
    const auto point = [&]() -> Vec3 {
      const double x = std::ldexp(std::floor(random.uniform(0.0, 0x1p40)), -40);
      const double y = std::ldexp(std::floor(random.uniform(0.0, 0x1p40)), -40);
      return {x, y, 12.0 - x - y};
    };
    const Vec3 a = point(), b = point(), c = point();
    Vec3 d = point();
    ASSERT_EQ(volume_sign(a, b, c, d), 0);
    const int side = volume_sign(a, b, c, {d[0], d[1], d[2] + 1.0});
    d[2] = std::nextafter(d[2], 100.0);
    ASSERT_EQ(volume_sign(a, b, c, d), side);
    ASSERT_NE(side, 0);
  }
}

}  // namespace
}  // namespace keepout::oracle
