// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/tip_jacobian.h"

#include "guards.h"
#include "messages.h"
#include "step/cycle.h"

namespace keepout {
namespace {

using Packed = Eigen::Matrix<double, 3, 7>;

MotionConstraint guard_with(double damping) {
  return guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.5, .damping = damping});
}

/// Returns the Jacobian of an arm of seven joints. All its numbers differ.
Packed seven_joints() {
  Packed jacobian;
  for (Eigen::Index i = 0; i < jacobian.size(); ++i)
    jacobian(i) = std::sin(1.0 + 2.0 * static_cast<double>(i));
  return jacobian;
}

class TipJacobianTypes : public ::testing::Test {
 protected:
  static Motion pressing() { return {.tip = {3, 4, 51}, .desired = {0.5, -0.2, -1.0}}; }

  /// Checks that a Jacobian of any type gives the same step as the same numbers column by column.
  template <class Jacobian>
  void expect_same(Jacobian&& jacobian) {
    const Motion motion{.tip = pressing().tip, .desired = pressing().desired, .jacobian = jacobian};
    ASSERT_EQ(motion.jacobian->joints(), jacobian.cols());
    EXPECT_EQ(motion.jacobian->matrix(), jacobian);
    const TipJacobian::Matrix packed = jacobian;
    Motion expected = pressing();
    expected.jacobian.emplace(packed.data(), packed.cols());
    const Step its = guard_.step(expected);
    ASSERT_EQ(its.status, Status::limited) << its.reason();
    const std::vector<double> increment(its.increment.begin(), its.increment.end());
    const Step step = guard_.step(motion);
    EXPECT_EQ(step.status, Status::limited);
    EXPECT_EQ(step.motion, its.motion);
    EXPECT_TRUE(std::equal(increment.begin(), increment.end(), step.increment.begin(),
                           step.increment.end()));
    EXPECT_GE((motion.tip + step.motion).z(), 50.5 - 1e-9);
  }

  MotionConstraint guard_ = guard_with(1e-6);
};

TEST_F(TipJacobianTypes, AreThoseThatEigenHasForAMatrix) {
  const Packed jacobian = seven_joints();
  expect_same(jacobian);
  Packed not_constant = jacobian;
  expect_same(not_constant);
  const Eigen::Matrix3d three = jacobian.leftCols<3>();
  expect_same(three);
  const Eigen::MatrixXd dynamic = jacobian;
  expect_same(dynamic);
  const Eigen::Matrix<double, 3, Eigen::Dynamic> three_rows = jacobian;
  expect_same(three_rows);
  const Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 8> bounded = jacobian;
  expect_same(bounded);
  const Eigen::Matrix<double, 3, 7, Eigen::RowMajor> row_by_row = jacobian;
  expect_same(row_by_row);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = jacobian;
  expect_same(rows);
}

TEST_F(TipJacobianTypes, AreAlsoPartsTransposesAndMapsOfOne) {
  Eigen::Matrix<double, 6, 7> of_a_frame;
  of_a_frame << seven_joints(), 2.0 * seven_joints();
  expect_same(of_a_frame.topRows<3>());
  expect_same(of_a_frame.bottomRows(3));
  expect_same(of_a_frame.topRows<3>().leftCols(4));
  const Eigen::MatrixXd dynamic = of_a_frame;
  expect_same(dynamic.topRows<3>());
  expect_same(dynamic.block(3, 1, 3, 5));
  const Eigen::Matrix<double, 6, 7, Eigen::RowMajor> row_by_row = of_a_frame;
  expect_same(row_by_row.topRows<3>());
  const Eigen::Matrix<double, 7, 3> on_its_side = seven_joints().transpose();
  expect_same(on_its_side.transpose());
  expect_same(Eigen::Map<const Packed>(of_a_frame.data()));
  using EverySecond = Eigen::InnerStride<2>;
  expect_same(Eigen::Map<const Packed, Eigen::Unaligned, EverySecond>(of_a_frame.data()));
  const Eigen::Ref<const Eigen::MatrixXd> reference = dynamic.topRows(3);
  expect_same(reference);
}

TEST_F(TipJacobianTypes, ASingleJointIsAColumn) {
  const Vec3 along(0.2, 0.1, -0.9);
  Motion motion = pressing();
  motion.jacobian = along;
  const Step step = guard_.step(motion);
  ASSERT_EQ(step.increment.size(), 1u) << step.reason();
  EXPECT_LT((step.motion - along * step.increment[0]).norm(), 1e-12);
}

TEST_F(TipJacobianTypes, OfOtherThanThreeRowsAreRefused) {
  for (const Eigen::Index rows : {0, 2, 4, 6}) {
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Ones(rows, 7);
    Motion motion = pressing();
    motion.jacobian = jacobian;
    const Step step = guard_.step(motion);
    EXPECT_EQ(step.status, Status::invalid_input);
    EXPECT_EQ(step.motion, Vec3::Zero());
    EXPECT_CONTAINS(step.reason(), "3 rows");
  }
}

TEST_F(TipJacobianTypes, ANumberThatIsNoneIsFoundWhereverItIs) {
  Eigen::Matrix<double, 6, 7> of_a_frame = Eigen::Matrix<double, 6, 7>::Zero();
  of_a_frame.topRows<3>() = seven_joints();
  of_a_frame.row(3).setConstant(std::nan(""));
  Motion motion = pressing();
  motion.jacobian = of_a_frame.topRows<3>();
  EXPECT_EQ(guard_.step(motion).status, Status::limited) << "what is beside it does not matter";
  for (Eigen::Index i = 0; i < 21; ++i) {
    Eigen::Matrix<double, 3, 7, Eigen::RowMajor> jacobian = seven_joints();
    jacobian(i) = std::nan("");
    motion.jacobian = jacobian;
    EXPECT_EQ(guard_.step(motion).status, Status::invalid_input);
  }
}

TEST(TipJacobian, OfMoreThanThreeJointsTellsThatItNeedsDamping) {
  const Packed jacobian = seven_joints();
  const Motion motion{.tip = {3, 4, 60}, .desired = {1, 0, 0}, .jacobian = jacobian};
  MotionConstraint undamped = guard_with(0.0);
  const Step step = undamped.step(motion);
  EXPECT_EQ(step.status, Status::ill_posed);
  EXPECT_CONTAINS(step.reason(), "more than three joints");
  EXPECT_CONTAINS(step.reason(), "set `damping` above 0");
  MotionConstraint damped = guard_with(1e-6);
  EXPECT_TRUE(damped.step(motion).ok());
}

constexpr double rounding = 1e-12;  // largest allowed error [length]

/// Returns the error of the tip's motion; empty if tip_motion returns no motion.
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

/// Each addend is lost in the digits of the sum, and all errors have the same sign.
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
