// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "keepout/fixtures/random.h"
#include "step/cycle.h"

namespace keepout {
namespace {

constexpr double rounding = 1e-12;  // that is to be kept to [length]

/// What the tip's motion is off by, where it is told; nothing where it is not.
std::optional<double> rounding_error(const std::vector<Vec3>& columns,
                                     const std::vector<double>& u) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Vec3 desired = Vec3::Zero();
  const StepProblem problem{.jacobian = {columns.front().data(), 3, n},
                            .desired = {desired.data(), 3},
                            .rows = {nullptr, 0, n},
                            .bounds = {nullptr, 0}};
  Solution solution;
  solution.u = u;
  const std::optional<Vec3> motion = tip_motion(problem, solution, rounding);
  if (!motion) return std::nullopt;
  Eigen::Matrix<long double, 3, 1> exact = Eigen::Matrix<long double, 3, 1>::Zero();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    exact += columns[c].cast<long double>() * static_cast<long double>(u[c]);
  }
  return static_cast<double>((motion->cast<long double>() - exact).norm());
}

/// Each addend is lost in the digits of the sum: all errors go one way.
TEST(TipMotion, OfManyJointsIsRoundedByNoMoreThanIsAllowed) {
  std::size_t told = 0;
  for (const int joints : {4, 7, 15, 38, 200}) {
    for (double size = 1.0; size < 1e5; size *= 1.3) {
      const double lost = 0.49 * (std::nextafter(size, 2.0 * size) - size);
      std::vector<Vec3> columns(static_cast<std::size_t>(joints), Vec3(lost, lost, -lost));
      columns.front() = Vec3(size, size, -size);
      columns.back() = -columns.front();
      const std::vector<double> u(columns.size(), 1.0);
      const std::optional<double> error = rounding_error(columns, u);
      if (!error) continue;
      ++told;
      ASSERT_LE(*error, rounding) << joints << " joints, columns of " << size;
    }
  }
  EXPECT_GT(told, 50u);
}

TEST(TipMotion, OfJointsThatAllButCancelIsRoundedByNoMoreThanIsAllowed) {
  Random random(38);
  std::size_t told = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    std::vector<Vec3> columns;
    std::vector<double> u;
    for (int pair = 0; pair < 19; ++pair) {
      const Vec3 column = random.direction() * std::pow(10.0, random.uniform(-3.0, 2.0));
      const double angle = std::pow(10.0, random.uniform(-4.0, 2.0));
      columns.insert(columns.end(), {column, column + 1e-9 * random.direction()});
      u.insert(u.end(), {angle, -angle});
    }
    const std::optional<double> error = rounding_error(columns, u);
    if (!error) continue;
    ++told;
    ASSERT_LE(*error, rounding);
  }
  EXPECT_GT(told, 100u);
}

}  // namespace
}  // namespace keepout
