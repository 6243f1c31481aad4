// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "nonnegative_least_squares.h"

#include <gtest/gtest.h>

#include "solvers/random_problems.h"

namespace keepout::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlopt::nonnegative_least_squares;
using nlopt::NonnegativeCombination;

TEST(NonnegativeLeastSquares, ATargetInTheConeIsMet) {
  const auto sum = nonnegative_least_squares(MatrixXd::Identity(3, 3), Eigen::Vector3d(1, 0, 2));
  EXPECT_EQ(sum.columns, (std::vector<Eigen::Index>{0, 2}));
  EXPECT_LT((sum.weights - Eigen::Vector2d(1, 2)).norm(), 1e-15);
  EXPECT_LT(sum.residual.norm(), 1e-15);
}

TEST(NonnegativeLeastSquares, ATargetBehindTheConeIsAnsweredByItsTip) {
  const auto sum = nonnegative_least_squares(MatrixXd::Identity(2, 2), Eigen::Vector2d(-1, -2));
  EXPECT_TRUE(sum.columns.empty());
  EXPECT_EQ(sum.residual, Eigen::Vector2d(-1, -2));
}

TEST(NonnegativeLeastSquares, NoColumnsLeaveTheTarget) {
  const auto sum = nonnegative_least_squares(MatrixXd(2, 0), Eigen::Vector2d(1, 2));
  EXPECT_EQ(sum.residual, Eigen::Vector2d(1, 2));
}

TEST(NonnegativeLeastSquares, EqualColumnsDoNotConfuseIt) {
  MatrixXd columns(2, 4);
  columns << 1, 1, 0, 0, 0, 0, 1, 1;
  const auto sum = nonnegative_least_squares(columns, Eigen::Vector2d(3, 4));
  EXPECT_EQ(sum.columns.size(), 2u);
  EXPECT_LT(sum.residual.norm(), 1e-15);
}

TEST(NonnegativeLeastSquares, SatisfiesTheConditionsOfItsOptimum) {
  // The residual is at right angles to the columns in use, and turned away from all others.
  for (int i = 0; i < 2000; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 12000000);
    const int n = random.integer(1, 8);
    MatrixXd columns(n, random.integer(1, 100));
    for (Eigen::Index c = 0; c < columns.cols(); ++c) columns.col(c) = random.direction(n);
    const VectorXd target = random.vector(n);
    const NonnegativeCombination sum = nonnegative_least_squares(columns, target);
    ASSERT_LE(sum.columns.size(), static_cast<std::size_t>(n));
    VectorXd combined = VectorXd::Zero(n);
    for (std::size_t k = 0; k < sum.columns.size(); ++k) {
      const double weight = sum.weights[static_cast<Eigen::Index>(k)];
      EXPECT_GT(weight, 0) << "seed " << i;
      combined += weight * columns.col(sum.columns[k]);
      EXPECT_NEAR(columns.col(sum.columns[k]).dot(sum.residual), 0, 1e-12) << "seed " << i;
    }
    EXPECT_LT((target - combined - sum.residual).norm(), 1e-12) << "seed " << i;
    EXPECT_LE((columns.transpose() * sum.residual).maxCoeff(), 1e-12) << "seed " << i;
  }
}

}  // namespace
}  // namespace keepout::test
