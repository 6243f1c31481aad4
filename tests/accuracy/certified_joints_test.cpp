// SPDX-License-Identifier: BSD-3-Clause
// With joints, the caller's own rows or too little capacity, each step is as safe, and its status
// reports each failure.

#include <span>

#include "accuracy/certified_loop.h"

namespace keepout::test::certified_joints {
namespace {

constexpr double radius = 1.0, margin = 0.25;

MotionConstraintSettings settings() {
  return {.options = {.radius = radius, .margin = margin, .damping = 1e-8},
          .capacity = {.planes = 200}};
}

TipJacobian::Matrix random_jacobian(Eigen::Index joints, Random& random) {
  TipJacobian::Matrix jacobian(3, joints);
  for (Eigen::Index c = 0; c < joints; ++c) {
    jacobian.col(c) = random.uniform(0.2, 2.0) * random.direction();
  }
  return jacobian;
}

/// Rows that limit each joint increment: |u_i| <= limit.
struct JointLimits {
  JointLimits(Eigen::Index joints, double limit)
      : matrix(2 * joints, joints), bounds(static_cast<std::size_t>(2 * joints), -limit) {
    matrix << StepProblem::RowMatrix::Identity(joints, joints),
        -StepProblem::RowMatrix::Identity(joints, joints);
  }

  ExtraRows rows() const { return {matrix.data(), bounds.data(), matrix.rows()}; }

  StepProblem::RowMatrix matrix;
  std::vector<double> bounds;
};

/// Returns the largest violation of a row.
double violation(const ExtraRows& rows, std::span<const double> u) {
  double worst = 0.0;
  const auto n = static_cast<Eigen::Index>(u.size());
  for (Eigen::Index r = 0; r < rows.count(); ++r) {
    double sum = 0.0;
    for (Eigen::Index c = 0; c < n; ++c) sum += rows.matrix()[r * n + c] * u[c];
    worst = std::max(worst, rows.bounds()[r] - sum);
  }
  return worst;
}

class CertifiedJoints : public testing::TestWithParam<const char*> {
 protected:
  CertifiedJoints() : loop(make_shape(GetParam()), settings()) {}

  struct Count {
    std::size_t cycles = 0, limited = 0, truncated = 0, not_ok = 0;
    double worst = 0.0, violation = 0.0, joints_off = 0.0;
  };

  /// Runs cycles that press into the surface, with random Jacobians of 3 to 7 joints.
  Count run(double limit) {
    Count count;
    Random random(3);
    for (const Vec3& start : places(loop, 25, 1.2 * margin, random)) {
      const auto joints = static_cast<Eigen::Index>(3 + random.below(5));
      const JointLimits limits(joints, limit);
      const Vec3 press = loop.towards_surface(start);
      Vec3 tip = start;
      for (int cycle = 0; cycle < 40; ++cycle) {
        const TipJacobian::Matrix jacobian = random_jacobian(joints, random);
        const Vec3 desired = random.uniform(0.1, 0.5) * (press + random.direction());
        Motion motion{.tip = tip, .desired = desired, .jacobian = jacobian};
        if (limit > 0.0) motion.rows = limits.rows();
        const Step step = loop.guard().step(motion);
        ++count.cycles;
        if (step.status == Status::limited) ++count.limited;
        if (step.status == Status::truncated) ++count.truncated;
        if (!step.ok()) ++count.not_ok;
        count.worst = std::max(count.worst, loop.loss(tip, tip + step.motion));
        EXPECT_LE(step.motion.norm(), radius * (1.0 + 1e-8));
        if (step.ok()) {
          const Eigen::Map<const Eigen::VectorXd> u(step.increment.data(), joints);
          count.joints_off = std::max(count.joints_off, (jacobian * u - step.motion).norm());
          if (limit > 0.0) {
            count.violation = std::max(count.violation, violation(limits.rows(), step.increment));
          }
        } else {
          EXPECT_EQ(step.motion, Vec3::Zero());
        }
        tip += step.motion;
      }
    }
    return count;
  }

  void expect(const Count& count) {
    EXPECT_GT(count.limited, count.cycles / 10);
    EXPECT_LE(count.worst, 3.0);
    EXPECT_LE(count.violation, 1e-10);
    EXPECT_LE(count.joints_off, 1e-10) << "the increment does not make the reported motion";
    EXPECT_LE(count.truncated, count.cycles / 50);
    EXPECT_LE(count.not_ok, count.cycles / 50);
  }

  Loop loop;
};

TEST_P(CertifiedJoints, KeepTheMarginAndTheMotionSphere) { expect(run(0.0)); }

TEST_P(CertifiedJoints, KeepTheirLimitsToo) { expect(run(0.15)); }

INSTANTIATE_TEST_SUITE_P(Shapes, CertifiedJoints,
                         testing::Values("cube", "gear", "cortex", "thin_plates", "saddle_terrain",
                                         "star_bumps"),
                         by_name);

TEST(CertifiedRows, OnTheTipItselfHoldAsWell) {
  Loop loop(make_shape("cube"), settings());  // its faces are at +-50
  const std::vector<double> row{1.0, 0.0, 0.0}, bound{-0.1};
  const Motion motion{.tip = {3, 4, 50.5},
                      .desired = {-0.5, 0.3, -0.6},
                      .rows = ExtraRows(row.data(), bound.data(), 1)};
  const Step step = loop.guard().step(motion);
  EXPECT_EQ(step.status, Status::limited);
  EXPECT_LT((step.motion - Vec3(-0.1, 0.3, -0.25)).norm(), 1e-8);
  ASSERT_EQ(step.active.size(), 2u);
  EXPECT_EQ(step.active.back(), step.planes.size()) << "the row comes after the planes";
}

TEST(CertifiedRows, ThatAskForMotionGetItOrAStatus) {
  Loop loop(make_shape("cube"), settings());
  const std::vector<double> up{0.0, 0.0, 1.0}, down{0.0, 0.0, -1.0}, bound{0.2};
  const Vec3 tip(3, 4, 50.0 + margin);
  const Step away = loop.guard().step(
      {.tip = tip, .desired = Vec3::Zero(), .rows = ExtraRows(up.data(), bound.data(), 1)});
  EXPECT_EQ(away.status, Status::limited);
  EXPECT_LT((away.motion - Vec3(0, 0, 0.2)).norm(), 1e-12);
  const Step into = loop.guard().step(
      {.tip = tip, .desired = Vec3::Zero(), .rows = ExtraRows(down.data(), bound.data(), 1)});
  EXPECT_FALSE(into.ok());
  EXPECT_EQ(into.status, Status::infeasible);
  EXPECT_EQ(into.motion, Vec3::Zero());
}

TEST(CertifiedRows, ThatAskForMoreThanTheMotionSphereGetNothing) {
  Loop loop(make_shape("cube"), settings());
  const std::vector<double> row{1.0, 0.0, 0.0}, bound{1.5};
  const Step step = loop.guard().step(
      {.tip = {3, 4, 52}, .desired = Vec3::Zero(), .rows = ExtraRows(row.data(), bound.data(), 1)});
  EXPECT_FALSE(step.ok()) << name(step.status);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(CertifiedRows, MoreThanRoomWasMadeForAreAStatus) {
  MotionConstraintSettings few = settings();
  few.capacity.extra_rows = 1;
  Loop loop(make_shape("cube"), few);
  const JointLimits limits(3, 1.0);
  const Step step =
      loop.guard().step({.tip = {3, 4, 52}, .desired = {0, 0, 0.1}, .rows = limits.rows()});
  EXPECT_EQ(step.status, Status::over_capacity);
}

TEST(CertifiedCapacity, WithoutRoomForAllTrianglesAShorterWayIsGone) {
  MotionConstraintSettings few = settings();
  few.index = "pd_tree";       // with a wide_bvh the rule gathers no triangles
  few.capacity.triangles = 8;  // a motion of 6 has up to about 60 in reach: edges are 2.2 long
  few.options.radius = 6.0;
  Loop loop(make_shape("sphere"), few);
  Random random(5);
  std::size_t truncated = 0, refused = 0, others = 0;
  for (Vec3 tip : places(loop, 60, 1.1 * margin, random)) {
    for (int cycle = 0; cycle < 20; ++cycle) {
      const Vec3 desired = random.uniform(1.0, 6.0) * random.direction();
      const Step step = loop.step(tip, desired);
      ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0);
      if (step.status == Status::truncated) {
        ++truncated;
        ASSERT_LE(step.motion.norm(), 0.5 * desired.norm() * (1.0 + 1e-9));
      } else if (step.status == Status::over_capacity) {
        ++refused;
        ASSERT_EQ(step.motion, Vec3::Zero());
      } else {
        ++others;
      }
      tip += step.motion;
    }
  }
  EXPECT_GT(truncated, 50u);
  EXPECT_GT(others, 50u);
  EXPECT_EQ(refused, 0u);
}

TEST(CertifiedCapacity, WithoutRoomForAnyTriangleNothingMoves) {
  MotionConstraintSettings few = settings();
  few.capacity.triangles = 1;
  Loop loop(make_shape("cortex"), few);
  Random random(6);
  for (const Vec3& tip : places(loop, 30, 1.01 * margin, random)) {
    const Step step = loop.step(tip, 0.9 * random.direction());
    ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0);
    if (!step.ok()) {
      ASSERT_EQ(step.status, Status::over_capacity);
    }
  }
}

TEST(CertifiedCapacity, OfTooFewPlanesIsAStatusOrASafeMotion) {
  MotionConstraintSettings few = settings();
  few.capacity.planes = 1;
  Loop loop(make_shape("gear"), few);
  Random random(7);
  std::size_t refused = 0;
  for (Vec3 tip : places(loop, 30, 1.1 * margin, random)) {
    for (int cycle = 0; cycle < 30; ++cycle) {
      const Step step = loop.step(tip, random.uniform(0.2, 1.0) * random.direction());
      ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0);
      if (step.status == Status::over_capacity || step.status == Status::truncated) ++refused;
      tip += step.motion;
    }
  }
  EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace keepout::test::certified_joints
