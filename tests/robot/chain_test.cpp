// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/chain.h"

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "chains.h"
#include "keepout/robot/denavit_hartenberg.h"
#include "keepout/robot/instrument.h"
#include "messages.h"

namespace keepout {
namespace {

using Matrix = Eigen::Matrix4d;

Matrix matrix(const Pose& pose) {
  Matrix m = Matrix::Identity();
  m.topLeftCorner<3, 3>() = pose.rotation;
  m.topRightCorner<3, 1>() = pose.position;
  return m;
}

/// Returns a rotation about an axis of the frame, 0 or 2, and a displacement along it.
Matrix screw(int axis, double angle, double way) {
  Matrix m = Matrix::Identity();
  const int next = (axis + 1) % 3;
  const int last = (axis + 2) % 3;
  m(next, next) = m(last, last) = std::cos(angle);
  m(last, next) = std::sin(angle);
  m(next, last) = -std::sin(angle);
  m(axis, 3) = way;
  return m;
}

Pose random_pose(Random& random) {
  return {300.0 * random.direction(),
          Eigen::AngleAxisd(random.uniform(-3, 3), random.direction()).toRotationMatrix()};
}

std::vector<DenavitHartenberg> random_table(Random& random) {
  std::vector<DenavitHartenberg> table(1 + random.below(Chain::most_joints));
  for (DenavitHartenberg& row : table) {
    row.kind = random.below(3) == 0 ? JointKind::prismatic : JointKind::revolute;
    row.a = random.uniform(-300, 300);
    row.alpha = random.uniform(-4, 4);
    row.d = random.uniform(-300, 300);
    row.theta = random.uniform(-4, 4);
  }
  return table;
}

/// Returns the largest difference of the flange's pose from a product of matrices. [mm]
double off_matrices(DhConvention convention, Random& random) {
  const std::vector<DenavitHartenberg> table = random_table(random);
  const Pose base = random_pose(random);
  const DhChain made = joints_of(table, convention);
  const Chain chain(made.joints, base, made.flange);
  const std::vector<double> q = test::configuration(chain, random);
  Matrix expected = matrix(base);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const DenavitHartenberg& row = table[i];
    const bool slides = row.kind == JointKind::prismatic;
    const Matrix x = screw(0, row.alpha, row.a);
    const Matrix z = screw(2, row.theta + (slides ? 0 : q[i]), row.d + (slides ? q[i] : 0));
    expected *= convention == DhConvention::modified ? Matrix(x * z) : Matrix(z * x);
  }
  const ChainState state = test::state_of(chain, q);
  return (matrix(state.flange()) - expected).cwiseAbs().maxCoeff();
}

TEST(Chain, StoresRotationsToOneRounding) {
  // docs/joint-space-step.md counts sqrt(3) u for each rotation, u = 2^-53. r^T r then differs from
  // the identity by twice that.
  Random random(12);
  double most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Pose base = random_pose(random);
    Joint joint{.kind = JointKind::prismatic, .origin = random_pose(random)};
    joint.origin.rotation += 1e-7 * Mat3::Random();  // as if given with six digits
    const Chain chain({joint}, base);
    const ChainState state = test::state_of(chain, std::vector<double>{0.0});
    const Chain without_base({joint});
    const ChainState of_joint = test::state_of(without_base, std::vector<double>{0.0});
    for (const Mat3& r : {state.link(0).rotation, of_joint.link(1).rotation}) {
      using Wide = Eigen::Matrix<long double, 3, 3>;
      const Wide wide = r.cast<long double>();
      const Wide missing = Wide::Identity() - wide.transpose() * wide;
      most = std::max(most, static_cast<double>(missing.norm()));
    }
  }
  EXPECT_LE(most, 2.0 * std::sqrt(3.0) * 0x1p-53);
  EXPECT_GT(most, 0.0);
}

TEST(Chain, ATableIsTheProductOfItsMatrices) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LT(off_matrices(DhConvention::modified, random), 2e-12);
    EXPECT_LT(off_matrices(DhConvention::standard, random), 2e-12);
  }
}

TEST(Chain, EachLinkIsMovedAboutItsOwnAxisWhereverThatPoints) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 turned_about = random.direction();
    // Almost opposite to z, where the rotation from z to the axis is ill-conditioned.
    const double tilt = std::pow(10.0, random.uniform(-9, 0));
    const Vec3 moved_along = Vec3(tilt * random.uniform(), tilt, -1).normalized();
    const Pose ways[] = {random_pose(random), random_pose(random), random_pose(random)};
    const Chain chain({{.origin = ways[1], .axis = turned_about},
                       {.kind = JointKind::prismatic, .origin = ways[2], .axis = moved_along}},
                      ways[0], random_pose(random));
    const double q[] = {random.uniform(-7, 7), random.uniform(-200, 200)};
    const ChainState state = test::state_of(chain, q);
    const Pose first =
        ways[0] * ways[1] * Pose{Vec3::Zero(), Eigen::AngleAxisd(q[0], turned_about).matrix()};
    const Pose second = first * ways[2] * Pose{q[1] * moved_along};
    EXPECT_LT((matrix(state.link(1)) - matrix(first)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((matrix(state.link(2)) - matrix(second)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((state.axis(1) - first.rotation * turned_about).norm(), 1e-14);
    EXPECT_LT((state.at(2, Vec3(1, 2, 3)) - second * Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_EQ(state.link(0).position, ways[0].position);
  }
}

TEST(Chain, TheJacobianIsTheDerivativeOfEachPointAndEachLinksTurn) {
  Random random(4);
  constexpr double step = 1e-4;
  for (int i = 0; i < 1000; ++i) {
    const Chain chain(joints_of(random_table(random), DhConvention::standard).joints);
    const std::vector<double> q = test::configuration(chain, random);
    const int link = static_cast<int>(random.below(static_cast<std::size_t>(chain.size()) + 1));
    const Vec3 point = 100.0 * random.direction();
    const ChainState state = test::state_of(chain, q);
    for (int k = 1; k <= chain.size(); ++k) {
      // Differences of four points: the error is of order step^4 times the lever, plus rounding.
      const auto at = [&](double steps) {
        std::vector<double> moved = q;
        moved[static_cast<std::size_t>(k - 1)] += steps * step;
        const ChainState there = test::state_of(chain, moved);
        return matrix(there.link(link) * Pose{point});
      };
      const Matrix slope = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * step);
      const Vec3 linear = state.linear(k, link, state.at(link, point));
      EXPECT_LT((linear - slope.topRightCorner<3, 1>()).norm(), 1e-7);
      const Mat3 spin = slope.topLeftCorner<3, 3>() * state.link(link).rotation.transpose();
      const Vec3 angular(spin(2, 1), spin(0, 2), spin(1, 0));
      EXPECT_LT((state.angular(k, link) - angular).norm(), 1e-10);
    }
  }
}

void expect_refused(const std::function<void()>& make, const std::string& words) {
  EXPECT_CONTAINS(error_of(make), words);
}

TEST(Chain, WhatIsNoChainIsRefusedAndTheMessageNamesTheJoint) {
  const auto chain = [](const Joint& joint) { return [=] { Chain({Joint{}, joint}); }; };
  expect_refused([] { Chain({}); }, "1 to 8 joints, not 0");
  expect_refused([] { Chain(std::vector<Joint>(9)); }, "1 to 8 joints, not 9");
  expect_refused(chain({.name = "elbow", .axis = Vec3::Zero()}), "joint 2 ('elbow') is not a unit");
  expect_refused(chain({.axis = Vec3(0, 0, 2)}), "joint 2 is not a unit vector");
  expect_refused(chain({.axis = Vec3(test::nan, 0, 1)}), "not a unit vector");
  expect_refused(chain({.origin = {Vec3(0, test::infinity, 0)}}),
                 "the origin of joint 2 is not a pose");
  expect_refused(chain({.origin = {Vec3::Zero(), -Mat3::Identity()}}), "the origin of joint 2");
  expect_refused(chain({.limits = {.lower = 1, .upper = 0}}), "lower limit above its upper");
  expect_refused(chain({.limits = {.lower = test::nan}}), "not a number");
  expect_refused(chain({.limits = {.lower = test::infinity}}), "joint 2 has a lower limit");
  expect_refused(chain({.limits = {.velocity = 0}}), "joint 2 has a limit of velocity");
  expect_refused(chain({.limits = {.increment = test::nan}}), "not above zero");
  expect_refused([] { Chain({Joint{}}, {Vec3(test::nan, 0, 0)}); }, "the base of the chain");
  expect_refused([] { Chain({Joint{}}, {}, {Vec3::Zero(), Mat3::Zero()}); }, "the flange");
  const DenavitHartenberg rows[] = {{}, {.alpha = test::nan}};
  expect_refused([&] { joints_of(rows, DhConvention::modified); }, "row 2 of the table");
}

TEST(Chain, WhatIsNoInstrumentIsRefusedAndTheMessageNamesTheBody) {
  const auto body = [](const Body& second) {
    return [=] { Instrument(Chain({Joint{}, Joint{}}), {{.points = {{}}}, second}); };
  };
  const std::vector<LinkPoint> triangle{{1}, {1, Vec3::UnitX()}, {2, Vec3::UnitY()}};
  expect_refused([] { Instrument(Chain({Joint{}}), {}); }, "1 to 16 bodies, not 0");
  expect_refused(body({.name = "tip"}), "body 2 ('tip') has 0 points");
  expect_refused(body({.points = {{3}}}), "body 2 is on link 3; there are links 0 to 2");
  expect_refused(body({.points = {{1, Vec3(test::nan, 0, 0)}}}),
                 "body 2 has a point that is not finite");
  expect_refused(body({.points = {{1}}, .radius = -1}),
                 "the radius of body 2 must be a length from 0 to 1e15, not -1");
  expect_refused(body({.points = triangle}), "only a capsule may reach from one link to another");
}

}  // namespace
}  // namespace keepout
