// SPDX-License-Identifier: BSD-3-Clause
// The certified clearance of one cycle is the least clearance of the next cycles. Rounding does not
// use it up over many cycles. A mesh that approaches lowers it only as far as reported.

#include "certified_clearance.h"
#include "guards.h"

namespace keepout {
namespace {

// A cycle may end up to two tolerances below the certified clearance. If the next cycle certified
// from there, the body would come nearer by the same amount in each cycle.
TEST(CertifiedFloor, IsNotUsedUpByATolerancePerCycle) {
  const InstrumentOptions options{.damping = 0.0};
  InstrumentConstraint guard = guard_of(wall(0.0), free_ball(0.0), options);
  const double kept = options.margin - options.band;
  for (const double share : {0.3, 0.9, 1.4, 1.9}) {
    SCOPED_TRACE(share);
    guard.forget();
    std::vector<double> q{kept, 0.0, 0.0};
    int moved = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
      const InstrumentStep step =
          guard.step(q, std::vector<double>{-share * guard.tolerance(), 0.0, 0.0});
      q = keepout::moved(q, step);
      ASSERT_GE(q[0], kept - 3.0 * guard.tolerance()) << "cycle " << cycle;
      moved += !step.increment.empty() && step.increment[0] < 0.0 ? 1 : 0;
    }
    EXPECT_GT(moved, 0) << "the command moves the body";
  }
}

// Rounding has brought a body 2 to 3 tolerances below the certified clearance. The body loses at
// most three tolerances in all, however long the command presses it on.
TEST(CertifiedFloor, LosesThreeTolerancesAtMostInAll) {
  for (const double recovery : {0.0, 1e-30, 0.05}) {
    for (const double below : {2.0, 2.2, 2.6, 2.95}) {
      SCOPED_TRACE(testing::Message() << recovery << ' ' << below);
      const InstrumentOptions options{.recovery = recovery, .damping = 0.0};
      InstrumentConstraint guard = guard_of(wall(0.0), free_ball(0.0), options);
      const double kept = options.margin - options.band;
      const double tau = guard.tolerance();
      std::vector<double> q{kept, 0.0, 0.0};
      static_cast<void>(guard.step(q, std::vector<double>{0.0, 0.0, 0.0}));
      double least = kept;
      int moved = 0;
      for (int cycle = 0; cycle < 20'000; ++cycle) {
        // Another controller holds the body there in every other cycle.
        if (cycle % 2 == 0) q[0] = kept - below * tau;
        const InstrumentStep step = guard.step(
            q, std::vector<double>{-0.01 * tau * (cycle % 7), 1e-4 * (cycle % 3 - 1), 0.0});
        const double before = q[0];
        q = keepout::moved(q, step);
        moved += step.ok() && q[0] != before ? 1 : 0;
        least = std::min(least, q[0]);
      }
      EXPECT_GE(least, kept - 3.0 * tau);
      EXPECT_GT(moved, 1'000);
    }
  }
}

// Rounding errors add up over motions along a wall, unless each motion regains what rounding took.
TEST(CertifiedFloor, IsRegainedByAMotionThatStartsBelowIt) {
  const InstrumentOptions options;
  InstrumentConstraint guard = guard_of(wall(0.0), free_ball(0.0), options);
  const double kept = options.margin - options.band;
  const double tau = guard.tolerance();
  const auto share = [&](double below, double along, double up) {
    guard.forget();
    const std::vector<double> q{kept - below * tau, 0.0, 0.0};
    return guard.prove(q, std::vector<double>{up * tau, along, 0.0}).fraction;
  };
  EXPECT_EQ(share(1.0, 0.1, 0.0), 1.0);
  EXPECT_EQ(share(2.5, 0.1, 0.0), 0.0);
  EXPECT_EQ(share(2.5, 0.1, 0.05), 0.0);
  EXPECT_EQ(share(2.5, 0.1, 0.3), 1.0);
}

// A wall approaches a point on an arm. The arm turns about an axis behind the wall, so every turn
// brings the point nearer, and the point cannot retreat. When the wall rests, the arm may turn only
// until the point has the clearance that the cycle with the moving wall reported.
TEST(CertifiedFloor, OfACycleThatYieldedIsKeptWhenTheMeshRests) {
  constexpr double lever = 100.0;
  constexpr double spare = 1e-4;
  const Instrument arm(Chain({{.kind = JointKind::revolute}}),
                       {{"point", {{1, Vec3(lever, 0, 0)}}, 1.0}});
  InstrumentOptions options{.recovery = 0.0};
  const double kept = options.margin - options.band;
  InstrumentConstraint guard = guard_of(wall(0.0), arm, options);
  const double fraction = 0.75;
  const double at = lever - 1.0 - fraction * kept - spare;  // where the wall comes to rest
  const double way = options.margin - fraction * kept - spare;
  guard.place(0, {Vec3(at - way, 0, 0), Mat3::Identity()},
              {.linear = Vec3(way / options.period, 0, 0)});
  std::vector<double> q{0.0};
  const InstrumentStep yielded = guard.step(q, std::vector<double>{0.0});
  ASSERT_EQ(yielded.status, Status::degraded) << yielded.reason();
  ASSERT_EQ(yielded.clearance_fraction, fraction);
  q[0] += yielded.increment[0];
  const Pose rest = guard.place_of(0);
  ASSERT_NEAR(rest.position.x(), at, 1e-9);
  guard.place(0, rest);
  for (int cycle = 0; cycle < 10; ++cycle) {
    const InstrumentStep step = guard.step(q, std::vector<double>{0.004});
    ASSERT_EQ(step.clearance_fraction, 1.0) << name(step.status);
    if (step.ok()) q[0] += step.increment[0];
    const double clear = lever * std::cos(q[0]) - 1.0 - rest.position.x();
    ASSERT_GE(clear, fraction * kept - 3.0 * guard.tolerance()) << name(step.status) << cycle;
    if (cycle == 0) {
      EXPECT_TRUE(step.ok()) << step.reason();
    }
  }
  EXPECT_GT(q[0], 1e-4) << "the arm moves";
}

constexpr double wanted_distance = 0.198;
constexpr double left_to_a_motion = 0.002;
constexpr double told_apart = 1e-9;

double certified_at(double distance, double floor) {
  return certified_clearance(distance, floor, wanted_distance, left_to_a_motion, told_apart);
}

// For bodies and guides: a start at the target distance or beyond is certified to the target
// itself.
TEST(CertifiedClearance, IsTheTargetWhereThatIsKeptHoweverLittleWasCertifiedBefore) {
  for (const double floor : {-1.0, 0.0, 0.1, wanted_distance, test::infinity}) {
    for (const double beyond : {0.0, 0.001, 0.5, -2.7 * told_apart}) {
      EXPECT_EQ(certified_at(wanted_distance + beyond, floor), wanted_distance)
          << floor << ' ' << beyond;
    }
  }
}

TEST(CertifiedClearance, BelowTheTargetLosesNothingThatWasCertified) {
  EXPECT_EQ(certified_at(0.15, 0.149), 0.149);
  EXPECT_EQ(certified_at(0.15, 0.1), 0.15 - left_to_a_motion)
      << "and gains what was recovered, less the room";
  EXPECT_EQ(certified_at(0.15, 0.15 + 3.5 * told_apart), 0.15 + 3.5 * told_apart)
      << "rounding lowers nothing";
  EXPECT_EQ(certified_at(0.15, 0.19), 0.15 - left_to_a_motion) << "moved by somebody else";
}

// Theorem 2 needs two facts. An accepted recovery ends within 2.75 tolerances of the target. A
// start that no cycle has certified is certified to its own distance, less the part that is left to
// a motion.
TEST(CertifiedClearance, IsLessThanTheTargetBeyond2_75TolerancesBelowItUnlessItWasCertified) {
  const double unknown = -test::infinity;
  for (const double below : {2.8, 2.9, 3.5, 3.9}) {
    const double distance = wanted_distance - below * told_apart;
    EXPECT_EQ(certified_at(distance, unknown), distance - left_to_a_motion) << below;
    EXPECT_EQ(certified_at(distance, 0.1), distance - left_to_a_motion) << below;
    EXPECT_EQ(certified_at(distance, wanted_distance), wanted_distance) << below;
  }
}

}  // namespace
}  // namespace keepout
