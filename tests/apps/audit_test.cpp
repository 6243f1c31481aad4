// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The independent check is itself checked: against shapes whose inside is known by formula.
#include "audit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/shapes.h"

namespace keepout::app {
namespace {

std::shared_ptr<const Mesh> mesh_of(Surface surface) {
  return std::make_shared<const Mesh>(std::move(surface));
}

TEST(InsideTest, AgreesWithTheFormulaOfACube) {
  const auto mesh = mesh_of(make_cube(5.0));
  const InsideTest inside(*mesh);
  Random random(1);
  for (const Vec3& point : random_points(*mesh, 20'000, random)) {
    ASSERT_EQ(inside(point), point.cwiseAbs().maxCoeff() < 50.0) << point.transpose();
  }
}

TEST(InsideTest, HoldsOnRaysThroughVerticesAndEdges) {
  // Coordinates of the vertices themselves: each ray runs through vertices and along faces.
  const auto mesh = mesh_of(make_cube(5.0));
  const InsideTest inside(*mesh);
  for (const Vec3& vertex : mesh->vertices()) {
    if (std::abs(vertex.y()) == 50.0 || std::abs(vertex.z()) == 50.0) continue;
    EXPECT_TRUE(inside(Vec3(0.5, vertex.y(), vertex.z())));
    EXPECT_FALSE(inside(Vec3(-51.0, vertex.y(), vertex.z())));
    EXPECT_FALSE(inside(Vec3(50.1, vertex.y(), vertex.z())));
  }
}

TEST(InsideTest, AgreesWithTheSolidAngleOnFoldsAndHandles) {
  // The solid angle of all triangles, seen from a point: 4 pi inside, 0 outside. Shares nothing
  // with counting rays.
  Random random(2);
  for (const char* name : {"cortex", "gear", "thin_plates", "star_bumps"}) {
    const auto mesh = mesh_of(make_shape(name));
    const InsideTest inside(*mesh);
    std::size_t insides = 0;
    for (const Vec3& point : random_points(*mesh, 200, random)) {
      double angle = 0.0;
      for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
        const Triangle c = mesh->triangle(t);
        const Vec3 a = c[0] - point, b = c[1] - point, d = c[2] - point;
        const double la = a.norm(), lb = b.norm(), ld = d.norm();
        angle += 2.0 * std::atan2(a.dot(b.cross(d)),
                                  la * lb * ld + a.dot(b) * ld + b.dot(d) * la + d.dot(a) * lb);
      }
      const bool expected = angle > 2.0 * 3.14159265358979;
      ASSERT_EQ(inside(point), expected) << name << " at " << point.transpose();
      insides += expected;
    }
    EXPECT_GT(insides, 5u) << name;
  }
}

TEST(Audit, ClearanceIsSignedOnAClosedMesh) {
  Audit audit(mesh_of(make_cube(10.0)));
  EXPECT_EQ(audit.surface(), SurfaceKind::closed);
  EXPECT_NEAR(audit.clearance({0, 0, 53}), 3.0, 1e-12);
  EXPECT_NEAR(audit.clearance({0, 0, 48}), -2.0, 1e-12);
  EXPECT_EQ(audit.clearance({1, 2, 50.0 - 1e-9}), 0.0) << "touching is not inside";
  EXPECT_NEAR(audit.clearance({1, 2, 50.0 - 1e-5}), -1e-5, 1e-12);
}

TEST(Audit, OfAMeshWoundInwardsTheOutsideIsForbidden) {
  Audit audit(mesh_of(make_concave_sphere(3.0)));
  EXPECT_GT(audit.clearance({0, 0, 10}), 0.0);
  EXPECT_LT(audit.clearance({0, 0, 60}), 0.0);
}

TEST(Audit, SeesAPassageThroughAThinPlateWithinOneStep) {
  const auto mesh = mesh_of(make_shape("thin_plates"));
  Audit audit(mesh);
  const double top = mesh->bounds().high.z();
  EXPECT_TRUE(audit.crosses({1, 2, top + 0.3}, {1, 2, top - 1.3})) << "through, into the gap";
  EXPECT_TRUE(audit.crosses({1, 2, top + 0.3}, {1, 2, top - 0.3})) << "into the plate";
  EXPECT_TRUE(audit.crosses({1, 2, top - 0.3}, {1, 2, top + 0.3})) << "out of the plate";
  EXPECT_FALSE(audit.crosses({1, 2, top + 0.3}, {1, 2, top + 0.1}));
  EXPECT_FALSE(audit.crosses({1, 2, top + 0.1}, {1, 2, top})) << "to touch is not to cross";
}

TEST(Audit, SlidingInContactOverRidgesIsNoCrossing) {
  const auto mesh = mesh_of(make_cube(10.0));
  Audit audit(mesh);
  // Along the top, over the right-angled ridge and on into free space, all of it on the surface.
  EXPECT_FALSE(audit.crosses({49.9, 0, 50}, {50.3, 0, 50}));
  EXPECT_FALSE(audit.crosses({49.9, 0, 50 - 1e-13}, {50.3, 0, 50 - 1e-13}));
  EXPECT_FALSE(audit.crosses({50, 0, 49.8}, {50, 0, 50.2}));
}

TEST(Audit, AnOpenSheetIsCrossedThroughItsFaceAndNotAroundItsRim) {
  const auto mesh = mesh_of(make_flat_plate(5.0, 1));  // at z = 0, 100 x 100
  Audit audit(mesh);
  EXPECT_EQ(audit.surface(), SurfaceKind::open);
  EXPECT_TRUE(audit.crosses({3, 4, 0.2}, {3, 4, -0.2}));
  EXPECT_TRUE(audit.crosses({3, 4, -0.2}, {3, 4, 0.2}));
  EXPECT_FALSE(audit.crosses({50.1, 4, 0.2}, {50.1, 4, -0.2}));
  EXPECT_FALSE(audit.crosses({3, 4, 0.0}, {8, 4, -1e-12})) << "the noise of a contact";
  EXPECT_NEAR(audit.clearance({3, 4, -2.0}), 2.0, 1e-12) << "unsigned where there is no inside";
}

}  // namespace
}  // namespace keepout::app
