// SPDX-License-Identifier: BSD-3-Clause
// Guides that contradict each other limit a motion only as far as necessary, and cost no clearance.

#include <Eigen/Dense>
#include <array>

#include "guards.h"
#include "guide_kinematics.h"

namespace keepout {
namespace {

/// Returns an arm of up to six revolute joints without limits, which carries a ball.
Instrument arm(int joints) {
  const Vec3 axes[] = {Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitY(),
                       Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX()};
  std::vector<Joint> all;
  for (int k = 0; k < joints; ++k) {
    all.push_back({.origin = {k == 0 ? Vec3(0, 0, 50) : Vec3(50, 0, 10)}, .axis = axes[k]});
  }
  return {Chain(all, {}, {Vec3(30, 0, 0)}), {{"tip", {{joints, Vec3(30, 0, 0)}}, 1.0}}};
}

std::shared_ptr<const Mesh> far_cube() { return mesh_of(moved(make_cube(20.0), {0, 0, -5000})); }

double excess(const Guide& guide, const ChainState& state) {
  return guide.region().excess(guided_point(guide, state));
}

/// Returns the damped least-squares flange motion that moves no guided point out, to first order.
std::vector<double> along_guides(const ChainState& state, const std::vector<Guide>& guides, int n,
                                 const Vec3& way) {
  const Vec3 at = state.flange().position;
  Eigen::MatrixXd jacobian(3, n);
  Eigen::MatrixXd normals(static_cast<int>(guides.size()), n);
  for (int k = 1; k <= n; ++k) {
    jacobian.col(k - 1) = state.linear(k, n, at);
    for (std::size_t g = 0; g < guides.size(); ++g) {
      const Vec3 outward = guides[g].region().outward(guided_point(guides[g], state));
      normals(static_cast<int>(g), k - 1) = outward.dot(guided_derivative(guides[g], state, k));
    }
  }
  const Eigen::MatrixXd gram = normals * normals.transpose() +
                               1e-9 * Eigen::MatrixXd::Identity(normals.rows(), normals.rows());
  const Eigen::MatrixXd along =
      Eigen::MatrixXd::Identity(n, n) - normals.transpose() * gram.ldlt().solve(normals);
  const Eigen::MatrixXd left = jacobian * along;
  const Eigen::Matrix3d damped = left * left.transpose() + 0.1 * Eigen::Matrix3d::Identity();
  const Eigen::VectorXd dq = along * left.transpose() * damped.ldlt().solve(way);
  return {dq.data(), dq.data() + n};
}

class ContradictingGuides : public testing::TestWithParam<int> {};

// The two guides are disjoint cones for one axis. The start is outside both by about 10 mrad.
TEST_P(ContradictingGuides, LeaveWhatBothAllow) {
  const int n = GetParam();
  Random random(static_cast<std::uint64_t>(n));
  int blocked = 0;
  int movable = 0;
  int cycles = 0;
  for (int scene = 0; scene < 40; ++scene) {
    InstrumentConstraint guard =
        guard_of(far_cube(), arm(n), {.orientation_weight = 0.0, .check_sides = false});
    const Chain& chain = guard.instrument().chain();
    std::vector<double> q;
    for (int k = 0; k < n; ++k) q.push_back(random.uniform(-1.5, 1.5));
    ChainState state = test::state_of(chain, q);
    const Vec3 axis = state.link(n).rotation.col(1);
    const Vec3 side =
        Eigen::AngleAxisd(random.uniform(0.0, 6.28), axis) * Vec3(axis.unitOrthogonal());
    std::vector<Guide> guides;
    for (const double sign : {1.0, -1.0}) {
      const double angle = sign * (0.1 + random.uniform(0.005, 0.015));
      guides.push_back(
          Guide::axis("cone", n, Vec3::UnitY(), Eigen::AngleAxisd(angle, side) * axis, 0.1));
    }
    guard.set_guides(guides);
    std::array<double, 2> least{1.0, 1.0};
    const auto are_kept = [&](const ChainState& at) {
      return excess(guides[0], at) <= least[0] + guides[0].band() + 1e-11 &&
             excess(guides[1], at) <= least[1] + guides[1].band() + 1e-11;
    };
    const double speed = 0.05 * std::pow(60.0, random.uniform());
    Vec3 way = Vec3::Zero();
    for (int cycle = 0; cycle < 50; ++cycle, ++cycles) {
      if (cycle % 10 == 0) way = speed * random.direction();
      chain.forward_kinematics(q, state);
      for (std::size_t g = 0; g < 2; ++g) least[g] = std::min(least[g], excess(guides[g], state));
      const Vec3 from = state.flange().position;
      const auto made = [&](const ChainState& at) {
        return 1.0 - (at.flange().position - from - way).norm() / speed;
      };
      const InstrumentStep step = guard.step(q, Twist{.linear = way});
      ASSERT_TRUE(step.ok()) << name(step.status) << " in scene " << scene << " cycle " << cycle;
      std::vector<double> to = q;
      ChainState there;
      for (int s = 1; s <= 8; ++s) {
        for (std::size_t k = 0; k < q.size(); ++k) to[k] = q[k] + s / 8.0 * step.increment[k];
        chain.forward_kinematics(to, there);
        ASSERT_TRUE(are_kept(there)) << "scene " << scene << " cycle " << cycle;
      }
      if (made(there) < 0.05) {
        ++blocked;
        std::vector<double> other = along_guides(state, guides, n, way);
        bool is_movable = false;
        for (int half = 0; half < 4 && !is_movable; ++half) {
          std::vector<double> end = q;
          for (std::size_t k = 0; k < q.size(); ++k) end[k] += other[k];
          const ChainState at_end = test::state_of(chain, end);
          is_movable =
              made(at_end) >= 0.1 && are_kept(at_end) && guard.prove(q, other).fraction == 1.0;
          for (double& number : other) number *= 0.5;
        }
        movable += is_movable ? 1 : 0;
      }
      q = to;
    }
  }
  EXPECT_LT(blocked, cycles / 5);
  EXPECT_LE(movable, blocked / 10) << "of " << blocked << " blocked cycles of " << cycles;
}

INSTANTIATE_TEST_SUITE_P(Arms, ContradictingGuides, testing::Values(4, 6));

// A guided point within its band is pulled back only if the motion that results costs less than
// standing still.
TEST(Guides, WithinTheirBandsDoNotStopTheTask) {
  Random random(11);
  int blocked = 0;
  int movable = 0;
  int cycles = 0;
  for (int scene = 0; scene < test::trials(400); ++scene) {
    InstrumentConstraint guard = guard_of(far_cube(), arm(3), {.check_sides = false});
    const Chain& chain = guard.instrument().chain();
    std::vector<double> q;
    for (int k = 0; k < 3; ++k) q.push_back(random.uniform(-1.5, 1.5));
    ChainState state = test::state_of(chain, q);
    const Vec3 axis = state.link(3).rotation.col(1);
    const double band = random.uniform(0.005, 0.03);
    const double angle = 0.1 + random.uniform(0.3, 0.9) * band;
    const Vec3 middle = Eigen::AngleAxisd(angle, axis.unitOrthogonal()) * axis;
    const std::vector<Guide> guides{
        Guide::axis("cone", 3, Vec3::UnitY(), middle, 0.1).with_band(band)};
    guard.set_guides(guides);
    const double speed = 0.5;
    Vec3 way = Vec3::Zero();
    for (int cycle = 0; cycle < 50; ++cycle, ++cycles) {
      if (cycle % 25 == 0) way = speed * random.direction();
      chain.forward_kinematics(q, state);
      const InstrumentStep step = guard.step(q, Twist{.linear = way});
      ASSERT_TRUE(step.ok()) << name(step.status) << " in scene " << scene;
      const auto made = [&](const std::vector<double>& increment) {
        std::vector<double> end = q;
        for (std::size_t k = 0; k < end.size(); ++k) end[k] += increment[k];
        const ChainState at_end = test::state_of(chain, end);
        const double excess_then = excess(guides[0], at_end);
        EXPECT_LE(excess_then, band + 1e-11) << "scene " << scene;
        return 1.0 - (at_end.flange().position - state.flange().position - way).norm() / speed;
      };
      const std::vector<double> increment(step.increment.begin(), step.increment.end());
      if (made(increment) < 0.05) {
        ++blocked;
        const std::vector<double> other = along_guides(state, guides, 3, way);
        movable += made(other) >= 0.1 && guard.prove(q, other).fraction == 1.0 ? 1 : 0;
      }
      for (std::size_t k = 0; k < q.size(); ++k) q[k] += increment[k];
    }
  }
  EXPECT_LE(movable, cycles / 100) << "of " << blocked << " blocked cycles of " << cycles;
}

// A planar arm far from a mesh that moves slowly. Its tip is inside a corridor; its elbow is pulled
// back into another one. The clearance does not require either guide to be relaxed.
TEST(ContradictingGuides, AreNotDroppedBesideADistantMeshThatMoves) {
  Surface far;
  far.vertices = {Vec3(0, 0, 2000), Vec3(100, 0, 2000), Vec3(0, 100, 2000)};
  far.triangles = {{0, 1, 2}};
  std::vector<Joint> joints(3);
  for (int k : {1, 2}) joints[static_cast<std::size_t>(k)].origin.position = Vec3(100, 0, 0);
  const LinkPoint tip{3, Vec3(100, 0, 0)};
  const LinkPoint elbow{2, Vec3(100, 0, 0)};
  Random random(7);
  const auto across = [&] {
    const double angle = random.uniform(0.0, 6.28);
    return Vec3(std::cos(angle), std::sin(angle), 0);
  };
  int pulled = 0;
  for (int scene = 0; scene < test::trials(500); ++scene) {
    InstrumentConstraint guard =
        guard_of(mesh_of(far), {Chain(joints, {}, {Vec3(100, 0, 0)}), {{"tip", {tip}, 1.0}}}, {});
    std::vector<double> q{random.uniform(-1, 1), random.uniform(-2, 2), random.uniform(-2, 2)};
    ChainState state = test::state_of(guard.instrument().chain(), q);
    const Vec3 n = across();
    const Vec3 off = random.uniform(1.1, 3.0) * n;
    const std::vector<Guide> guides{
        Guide::point("corridor", tip,
                     Region::slab(state.at(tip.link, tip.position), across(), 1.0)),
        Guide::point("elbow", elbow,
                     Region::slab(state.at(elbow.link, elbow.position) + off, n, 1.0))};
    guard.set_guides(guides);
    guard.place(0, {}, {.linear = Vec3(1e-9, 0, 0)});
    const Vec3 way = 0.5 * across();
    for (int cycle = 0; cycle < 60; ++cycle) {
      const InstrumentStep step = guard.step(q, Twist{.linear = way});
      ASSERT_TRUE(step.ok()) << name(step.status);
      for (const GuideState& guide : step.guides)
        ASSERT_FALSE(guide.relaxed && guide.excess <= 0.0);
      pulled += step.guides[1].excess > 0.0 ? 1 : 0;
      q = moved(q, step);
      guard.instrument().chain().forward_kinematics(q, state);
      ASSERT_LE(excess(guides[0], state), guides[0].band() + 1e-9) << "scene " << scene;
    }
  }
  EXPECT_GT(pulled, test::trials(500));
}

// A sheet approaches a ball that up to three guides hold in its path. Two of them contradict each
// other. Guides are relaxed first, so the ball keeps all of its clearance.
TEST(ContradictingGuides, CostNoClearanceFromAMeshThatComesOn) {
  std::vector<Joint> slides;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    slides.push_back({.kind = JointKind::prismatic,
                      .axis = axis,
                      .limits = {.lower = -50.0, .upper = 50.0, .velocity = 1000.0}});
  }
  const Surface sheet{{Vec3(-40, -40, 0), Vec3(40, -40, 0), Vec3(0, 60, 0)}, {{0, 1, 2}}};
  const LinkPoint tip{3, Vec3::Zero()};
  const Guide above = Guide::point("above", tip, Region::ball(Vec3(1.0, 0, 0.5), 0.9));
  const Guide beside = Guide::point("beside", tip, Region::ball(Vec3(-1.0, 0, 0.5), 0.9));
  const Guide low = Guide::point("low", tip, Region::half_space(Vec3(0, 0, 0.2), -Vec3::UnitZ()));
  const std::vector<std::vector<Guide>> sets{{above, beside}, {low}, {above, beside, low}};
  for (const std::vector<Guide>& guides : sets) {
    SCOPED_TRACE(guides.size());
    InstrumentConstraint guard = guard_of(mesh_of(sheet), {Chain(slides), {{"ball", {tip}, 1.0}}},
                                          {.damping = 1e-9, .orientation_weight = 0.0});
    guard.set_guides(guides);
    std::vector<double> q{0.0, 0.0, 0.0};
    Random random(3);
    int relaxed = 0;
    for (int cycle = 0; cycle < 400; ++cycle) {
      const double z = -4.0 + 0.02 * cycle;
      guard.place(0, {Vec3(0, 0, z), Mat3::Identity()}, {.linear = Vec3(0, 0, 20)});
      const InstrumentStep step = guard.step(q, Twist{.linear = 0.3 * random.direction()});
      ASSERT_TRUE(step.ok()) << name(step.status) << " in cycle " << cycle;
      ASSERT_TRUE(step.degraded.empty()) << cycle;
      ASSERT_EQ(step.clearance_fraction, 1.0);
      q = moved(q, step);
      ASSERT_GE(q[2] - (z + 0.02) - 1.0, 0.198 - 1e-8) << cycle;
      if (step.relaxation != Relaxation::guides) continue;
      ++relaxed;
      ASSERT_TRUE(step.limits.has(Limit::guide)) << cycle;
    }
    EXPECT_GT(relaxed, 20);
  }
}

}  // namespace
}  // namespace keepout
