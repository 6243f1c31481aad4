// SPDX-License-Identifier: BSD-3-Clause
//
// Tests the judge of all solvers: it accepts an optimum computed by hand, and rejects every way of
// spoiling it.
#include "keepout/solvers/kkt.h"

#include "keepout/fixtures/random_problems.h"
#include "trials.h"

namespace keepout::test {
namespace {

/// A point with target (3, 0.5, -2) in the box -1 <= u <= 1, and its optimum in a corner.
struct Corner {
  Corner() {
    problem.jacobian = StepProblem::Matrix::Identity(3, 3);
    problem.desired = Eigen::Vector3d(3, 0.5, -2);
    problem.rows.resize(6, 3);
    problem.rows << -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1;
    problem.bounds = Eigen::VectorXd::Constant(6, -1);
  }

  KktResidual residual() const {
    return kkt_residual(problem.view(), {.u = u, .multipliers = multipliers, .active = active});
  }

  Problem problem;
  /// Returns |d| / |J|, which is larger than |u| here.
  double reach() const { return problem.desired.norm() / std::sqrt(3.0); }

  std::vector<double> u = {1, 0.5, -1};
  std::vector<double> multipliers = {4, 2};
  std::vector<std::uint32_t> active = {0, 5};
};

TEST(KktResidual, IsZeroAtAnOptimumWorkedOutByHand) { EXPECT_EQ(Corner().residual().worst(), 0); }

TEST(KktResidual, SeesAPointThatIsFeasibleButNotBest) {
  Corner corner;
  corner.u[1] = 0.25;
  const KktResidual residual = corner.residual();
  EXPECT_NEAR(residual.stationarity, 0.25 / (corner.problem.desired.norm() + 2 + 1), 1e-15);
  EXPECT_EQ(residual.primal, 0);
}

TEST(KktResidual, SeesAViolatedRowRelativeToItsNormAndTheMotion) {
  Corner corner;
  corner.problem.rows.row(3) *= 1000;
  corner.problem.bounds[3] *= 1000;
  corner.u = {1, -1.5, -1};
  EXPECT_NEAR(corner.residual().primal, 0.5 / corner.reach(), 1e-15);
}

TEST(KktResidual, SeesAMultiplierThatPulls) {
  Corner corner;
  corner.multipliers[1] = -2;
  EXPECT_NEAR(corner.residual().dual, 1 / (corner.problem.desired.norm() + 2 + 1), 1e-15);
}

TEST(KktResidual, SeesAMultiplierOnARowThatIsNotTouched) {
  Corner corner;
  corner.active[1] = 4;
  EXPECT_NEAR(corner.residual().complementarity, 2 / corner.reach(), 1e-15);
}

TEST(KktResidual, SeesAForgottenActiveRow) {
  Corner corner;
  corner.active.pop_back();
  corner.multipliers.pop_back();
  EXPECT_NEAR(corner.residual().stationarity, 1 / (corner.problem.desired.norm() + 2), 1e-15);
}

TEST(KktResidual, SeesAnErrorAlongTheWeakDirectionOfTheTask) {
  // The gradient in u would be 1e-12: only task space shows the error.
  Problem problem;
  problem.jacobian = Eigen::Vector2d(1, 1e-6).asDiagonal();
  problem.desired = Eigen::Vector2d(1, 1);
  problem.rows.resize(0, 2);
  problem.bounds.resize(0);
  const std::vector<double> u = {1, 0.9e6};
  const KktResidual residual =
      kkt_residual(problem.view(), {.u = u, .multipliers = {}, .active = {}});
  EXPECT_NEAR(residual.stationarity, 0.1 / std::sqrt(2.0), 1e-12);
}

TEST(KktResidual, IsInfiniteForAZeroRowThatAsksForSomething) {
  Corner corner;
  corner.problem.rows.row(3).setZero();
  corner.problem.bounds[3] = 1e-300;
  EXPECT_EQ(corner.residual().primal, infinity);
}

TEST(KktResidual, IsInfiniteForWhatIsNoSolutionInForm) {
  const auto infinite = [](const Corner& corner) { return corner.residual().worst() == infinity; };
  Corner corner;
  corner.u.pop_back();
  EXPECT_TRUE(infinite(corner)) << "too few variables";
  corner = {};
  corner.u[0] = nan;
  EXPECT_TRUE(infinite(corner)) << "not a number";
  corner = {};
  corner.multipliers.push_back(0);
  EXPECT_TRUE(infinite(corner)) << "a multiplier without a row";
  corner = {};
  corner.active = {5, 0};
  EXPECT_TRUE(infinite(corner)) << "out of order";
  corner = {};
  corner.active = {5, 5};
  EXPECT_TRUE(infinite(corner)) << "twice";
  corner = {};
  corner.active = {0, 6};
  EXPECT_TRUE(infinite(corner)) << "out of range";
}

}  // namespace
}  // namespace keepout::test
