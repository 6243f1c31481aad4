// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/registration.h"

#include <Eigen/Geometry>

#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::registration {
namespace {

constexpr RegistrationUnits metres_to_millimetres{.transform = LengthUnit::millimetre,
                                                  .robot = LengthUnit::metre,
                                                  .mesh = LengthUnit::millimetre};

Mat3 turned(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

Eigen::Matrix4d matrix_of(const Mat3& rotation, const Vec3& translation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation;
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

std::string complaint(const Eigen::Matrix4d& matrix,
                      const RegistrationUnits& units = metres_to_millimetres) {
  std::string message;
  for (const auto make : {&Registration::mesh_from_robot, &Registration::robot_from_mesh}) {
    message = error_of([&] { make(matrix, units); });
    EXPECT_NE(message, "no error");
  }
  return message;
}

TEST(Registration, BringsPointsOfTheRobotIntoTheFrameAndUnitOfTheMesh) {
  const Mat3 quarter = turned(std::acos(0.0), Vec3::UnitZ());
  const auto registration =
      Registration::mesh_from_robot(matrix_of(quarter, {10, 20, 30}), metres_to_millimetres);
  EXPECT_LT((registration.point_to_mesh({0.1, 0, 0}) - Vec3(10, 120, 30)).norm(), 1e-12);
  EXPECT_LT((registration.vector_to_mesh({0.1, 0, 0}) - Vec3(0, 100, 0)).norm(), 1e-12);
  EXPECT_LT((registration.force_to_mesh({3, 0, 0}) - Vec3(0, 3, 0)).norm(), 1e-12);
  EXPECT_EQ(registration.scale(), 1000.0);
}

TEST(Registration, RoundTripsAreExactToRounding) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix4d matrix =
        matrix_of(turned(3.0 * normal(random), random.direction()), 300.0 * random.direction());
    const auto there = Registration::mesh_from_robot(matrix, metres_to_millimetres);
    const auto back = Registration::robot_from_mesh(matrix.inverse(), metres_to_millimetres);
    const Vec3 point = 0.2 * random.direction();
    EXPECT_LT((there.point_to_robot(there.point_to_mesh(point)) - point).norm(), 1e-15);
    EXPECT_LT((there.vector_to_robot(there.vector_to_mesh(point)) - point).norm(), 1e-15);
    EXPECT_LT((there.force_to_robot(there.force_to_mesh(point)) - point).norm(), 1e-15);
    EXPECT_LT((there.point_to_mesh(point) - back.point_to_mesh(point)).norm(), 1e-11);
  }
}

TEST(Registration, TheTranslationHasAUnitOfItsOwn) {
  const auto in_metres = Registration::mesh_from_robot(
      matrix_of(Mat3::Identity(), {0.01, 0.02, 0.03}),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
  EXPECT_LT((in_metres.point_to_mesh(Vec3::Zero()) - Vec3(10, 20, 30)).norm(), 1e-12);
  const auto mesh_in_metres = Registration::robot_from_mesh(
      matrix_of(Mat3::Identity(), {10, 20, 30}), {.transform = LengthUnit::millimetre,
                                                  .robot = LengthUnit::millimetre,
                                                  .mesh = LengthUnit::metre});
  EXPECT_LT((mesh_in_metres.point_to_mesh({10, 20, 1030}) - Vec3(0, 0, 1)).norm(), 1e-15);
}

TEST(Registration, WhatIsARotationToFourDigitsIsTakenForTheNearestOne) {
  Mat3 rounded = turned(0.7, {1, 2, 3});
  for (int i = 0; i < 9; ++i) rounded.data()[i] = std::round(1e5 * rounded.data()[i]) * 1e-5;
  const auto registration =
      Registration::mesh_from_robot(matrix_of(rounded, Vec3::Zero()), metres_to_millimetres);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    EXPECT_NEAR(registration.force_to_mesh(axis).norm(), 1.0, 1e-15);
  }
}

TEST(Registration, AReflectionIsRefused) {
  Mat3 mirrored = turned(0.4, {1, 1, 0});
  mirrored.col(1) *= -1.0;
  EXPECT_CONTAINS(complaint(matrix_of(mirrored, Vec3::Zero())), "a reflection");
  EXPECT_CONTAINS(complaint(matrix_of(-Mat3::Identity(), Vec3::Zero())), "a reflection");
}

TEST(Registration, AScaleIsRefusedAndMetresForMillimetresSuspected) {
  const Mat3 rotation = turned(0.4, {1, 1, 0});
  EXPECT_CONTAINS(complaint(matrix_of(1000.0 * rotation, Vec3::Zero())), "it scales by 1000;");
  EXPECT_CONTAINS(complaint(matrix_of(0.001 * rotation, Vec3::Zero())), "it scales by 0.001;");
  EXPECT_CONTAINS(complaint(matrix_of(1.001 * rotation, Vec3::Zero())), "it scales by 1.001;");
}

TEST(Registration, WhatJustMissesARotationIsNotCalledAReflection) {
  EXPECT_CONTAINS(complaint(matrix_of(1.00007 * Mat3::Identity(), Vec3::Zero())),
                  "it scales by 1.00007;");
  EXPECT_CONTAINS(complaint(matrix_of(Vec3(1.00007, 1, 1).asDiagonal(), Vec3::Zero())),
                  "it stretches by 1.00007");
}

TEST(Registration, OtherMatricesAreRefusedForWhatTheyAre) {
  EXPECT_CONTAINS(complaint(matrix_of(Vec3(1, 1, 2).asDiagonal(), Vec3::Zero())),
                  "it stretches by 2");
  EXPECT_CONTAINS(complaint(matrix_of(Vec3(1, 1, 0).asDiagonal(), Vec3::Zero())), "it flattens");
  EXPECT_CONTAINS(complaint(matrix_of(Mat3::Zero(), Vec3::Zero())), "all zeros");
  EXPECT_CONTAINS(complaint(matrix_of(Mat3::Identity(), {0, test::nan, 0})), "not finite");
  Mat3 huge = Mat3::Identity();
  huge(0, 0) = 1e200;
  EXPECT_CONTAINS(complaint(matrix_of(huge, Vec3::Zero())), "not a rotation");
  Eigen::Matrix4d transposed = matrix_of(Mat3::Identity(), {10, 20, 30}).transpose();
  EXPECT_CONTAINS(complaint(transposed), "transposed");
}

TEST(Registration, ATranslationInTheWrongUnitIsRefused) {
  const Eigen::Matrix4d matrix = matrix_of(Mat3::Identity(), {100, 200, 50});
  EXPECT_CONTAINS(complaint(matrix, {.transform = LengthUnit::metre,
                                     .robot = LengthUnit::metre,
                                     .mesh = LengthUnit::millimetre}),
                  "is its unit millimeters?");
}

TEST(Registration, AForgottenUnitIsAskedFor) {
  const Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  EXPECT_CONTAINS(complaint(matrix, {}), "say the unit of the matrix's translation");
  EXPECT_CONTAINS(complaint(matrix, {.transform = LengthUnit::metre}), "of the robot's poses");
  EXPECT_CONTAINS(complaint(matrix, {.transform = LengthUnit::metre, .robot = LengthUnit::metre}),
                  "of the mesh");
}

TEST(Pose, QuaternionsAndRotationsAgree) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 rotation = turned(3.2 * normal(random), random.direction());
    const Quaternion q = to_quaternion(rotation);
    EXPECT_GE(q.w, 0.0);
    const auto back = to_rotation(q);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - rotation).cwiseAbs().maxCoeff(), 1e-14);
    // The negative quaternion is the same rotation.
    EXPECT_LT((*to_rotation({-q.x, -q.y, -q.z, -q.w}) - rotation).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Pose, AnEmptyOrBrokenQuaternionIsNoRotation) {
  EXPECT_FALSE(to_rotation({0, 0, 0, 0}));
  EXPECT_FALSE(to_rotation({0, 0, 0, 2}));
  EXPECT_FALSE(to_rotation({test::nan, 0, 0, 1}));
  EXPECT_FALSE(to_rotation({1e200, 0, 0, 1}));
  EXPECT_TRUE(to_rotation({0, 0, 0, 1}));
}

TEST(Pose, IsValidOnlyWithAFinitePositionAndARotation) {
  EXPECT_TRUE(is_valid(Pose{}));
  EXPECT_FALSE(is_valid({.position = {0, test::infinity, 0}}));
  EXPECT_FALSE(is_valid({.rotation = Mat3::Zero()}));
  EXPECT_FALSE(is_valid({.rotation = -Mat3::Identity()}));
  EXPECT_FALSE(is_valid({.rotation = Mat3::Constant(1e300)}));
}

}  // namespace
}  // namespace keepout::test::registration
