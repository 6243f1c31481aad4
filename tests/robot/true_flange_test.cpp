// SPDX-License-Identifier: BSD-3-Clause
// Compares the true motion of the flange with the linear task that the solver receives. Joints
// without velocity limits turn far near a singular pose, where the two differ most.

#include "guards.h"

namespace keepout {
namespace {

constexpr int steps_of_a_chain = 25;

Chain draw_chain(Random& random) {
  std::vector<Joint> joints;
  for (int k = 0; k < 6; ++k) {
    joints.push_back(
        {.origin = {random.uniform(0.0, 100.0) * random.direction()}, .axis = random.direction()});
  }
  return Chain(std::move(joints), {}, {random.uniform(0.0, 100.0) * random.direction()});
}

/// Returns the distance of `to` from `from` moved by a twist, weighted as in the task.
double missed(const Pose& from, const Pose& to, const Twist& desired, double weight) {
  const Eigen::AngleAxisd turn(Mat3(to.rotation * from.rotation.transpose()));
  return std::hypot((to.position - from.position - desired.linear).norm(),
                    weight * (turn.angle() * turn.axis() - desired.angular).norm());
}

struct Tally {
  int shortened = 0;  // because the true motion departs from the linear task
  int truncated = 0;
  std::vector<double> missed = {};  // of each step, as a fraction of what zero motion misses
};

void run(double speed, Tally& tally) {
  Random random(341);
  const auto mesh = wall(5000.0);
  for (int scene = 0; scene < test::trials(2000) / steps_of_a_chain; ++scene) {
    const Chain chain = draw_chain(random);
    auto guard = guard_of(mesh, {chain, {{"tip", {{6, Vec3::Zero()}}, 1.0}}});
    const double weight = guard.options().orientation_weight;
    std::vector<double> q = test::configuration(chain, random);
    for (int i = 0; i < steps_of_a_chain; ++i) {
      const Twist desired{.linear = speed * 0.5 * random.direction(),
                          .angular = speed * 0.02 * random.direction()};
      const InstrumentStep step = guard.step(q, desired);
      ASSERT_TRUE(step.ok()) << step.reason();
      const ChainState before = test::state_of(chain, q);
      q = moved(q, step);
      const ChainState after = test::state_of(chain, q);
      tally.missed.push_back(missed(before.flange(), after.flange(), desired, weight) /
                             missed(before.flange(), before.flange(), desired, weight));
      ASSERT_LE(tally.missed.back(), 1.05) << name(step.status);
      const bool is_shortened = step.limits.has(Limit::linearization);
      tally.shortened += is_shortened ? 1 : 0;
      tally.truncated += step.limits.has(Limit::truncated) ? 1 : 0;
      // Far from the mesh, no other cause shortens a motion.
      ASSERT_EQ(step.status == Status::truncated, step.limits.has(Limit::truncated));
      const bool is_singular = step.limits.has(Limit::singularity);
      ASSERT_TRUE(is_shortened || is_singular || step.status == Status::free);
      ASSERT_TRUE(step.status != Status::free || tally.missed.back() <= 0.5 + 1e-9);
      for (double& position : q) position = std::remainder(position, 2.0 * std::numbers::pi);
    }
  }
}

class TrueFlange : public testing::TestWithParam<int> {};

TEST_P(TrueFlange, NeverEndsFartherFromWhatWasAskedThanWhereItStood) {
  Tally tally;
  run(GetParam(), tally);
  ASSERT_FALSE(HasFatalFailure());
  std::ranges::sort(tally.missed);
  const auto at = [&](double share) {
    return tally.missed[static_cast<std::size_t>(share * static_cast<double>(tally.missed.size()))];
  };
  // The median must be near that of the linear task at speed 1 (0.10), and below it at 20 (1.1).
  EXPECT_LT(at(0.5), GetParam() == 1 ? 0.15 : 0.6);
  EXPECT_GT(tally.shortened, test::trials(200));
  EXPECT_GE(tally.truncated, test::trials(2000) / 400);
}

INSTANTIATE_TEST_SUITE_P(Speeds, TrueFlange, testing::Values(1, 5, 20));

}  // namespace
}  // namespace keepout
