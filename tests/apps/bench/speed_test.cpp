// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/speed.h"

#include <numeric>

#include "keepout/index/query.h"
#include "meshes.h"
#include "messages.h"

namespace keepout::app {
namespace {

TEST(Timing, IsByNearestRankAndLeavesOutWhatTooFewSamplesCannotTell) {
  using Percentile = std::optional<double>;
  const struct {
    std::size_t samples;
    double p50;
    Percentile p99, p999;
  } cases[] = {
      {1, 1.0, {}, {}}, {99, 50.0, {}, {}}, {999, 500.0, 990.0, {}}, {1000, 500.0, 990.0, 999.0}};
  for (const auto& [count, p50, p99, p999] : cases) {
    SCOPED_TRACE(count);
    std::vector<double> samples(count);
    std::iota(samples.rbegin(), samples.rend(), 1.0);  // count, ..., 2, 1
    const Timing timing = timing_of(samples);
    EXPECT_EQ(timing.p50, p50);
    EXPECT_EQ(timing.p99, p99);
    EXPECT_EQ(timing.p999, p999);
    EXPECT_EQ(timing.max, static_cast<double>(count));
    EXPECT_EQ(timing.samples, count);
  }
}

TEST(Timing, OfVeryManyTimesIsThatOfAnEvenPartAndOfTheLongest) {
  Times times;
  EXPECT_EQ(times.timing().samples, 0u);
  constexpr std::size_t count = 5'000'000;
  for (std::size_t i = 0; i < count; ++i) times.add(i == 7 ? 1e9 : static_cast<double>(i % 1000));
  const Timing timing = times.timing();
  EXPECT_EQ(timing.samples, count);
  EXPECT_EQ(timing.max, 1e9);
  EXPECT_NEAR(timing.p50, 500.0, 8.0);  // one of eight times is stored
  EXPECT_NEAR(timing.p99.value_or(0.0), 990.0, 8.0);
}

TEST(Timing, OfSeveralPassesIsTheLeastOfEachPercentile) {
  const Timing one{.p50 = 1.0, .p99 = 5.0, .p999 = {}, .max = 9.0, .samples = 100};
  const Timing other{.p50 = 2.0, .p99 = 4.0, .p999 = {}, .max = 8.0, .samples = 100};
  const Timing least = least_of(one, other);
  EXPECT_EQ(least.p50, 1.0);
  EXPECT_EQ(least.p99, 4.0);
  EXPECT_EQ(least.p999, std::nullopt);
  EXPECT_EQ(least.max, 8.0);
}

TEST(Timing, OfWhatIsShorterThanTheClockIsInBatches) {
  int done = 0;
  const MeasuredSide quick = timed("quick", 64, 2, [&](std::size_t) { ++done; });
  EXPECT_EQ(quick.batch, 32u);
  EXPECT_EQ(done, 2 * 64 + 2 * 64) << "each pass one by one, and in batches";
  EXPECT_LE(quick.us.p50, quick.us.max);
  const MeasuredSide slow = timed_whole("slow", 3, [] {
    const BenchClock::time_point start = BenchClock::now();
    while (microseconds_since(start) < 50.0) {
    }
  });
  EXPECT_EQ(slow.batch, 1u);
  EXPECT_GE(slow.us.p50, 50.0);
}

TEST(TimeHistogram, ABinTellsATimeToAnEighth) {
  Random random(1);
  for (int i = 0; i < 10'000; ++i) {
    const auto ns = static_cast<std::uint64_t>(std::exp2(random.uniform(3.0, 31.9)));
    const std::size_t bin = TimeHistogram::bin_of(ns);
    const double low = TimeHistogram::beginning_of(bin),
                 high = TimeHistogram::beginning_of(bin + 1);
    EXPECT_LE(low, static_cast<double>(ns));
    EXPECT_GT(high, static_cast<double>(ns));
    EXPECT_LE(high, 1.125 * low * (1.0 + 1e-12));
  }
}

TEST(TimeHistogram, CountsWhatIsOutsideInTheBinsAtTheEnds) {
  TimeHistogram histogram;
  histogram.add(0);
  histogram.add(~std::uint64_t{0});
  EXPECT_EQ(histogram.count(0), 1u);
  EXPECT_EQ(histogram.count(TimeHistogram::bins - 1), 1u);
  EXPECT_EQ(histogram.total(), 2u);
  EXPECT_EQ(histogram.longest(), ~std::uint64_t{0});
}

TEST(TimeHistogram, APercentileIsTheEndOfTheBinThatReachesIt) {
  TimeHistogram histogram;
  EXPECT_FALSE(histogram.percentile(0.5).has_value());
  for (int i = 0; i < 999; ++i) histogram.add(100);
  histogram.add(5000);
  const double of_100 = TimeHistogram::beginning_of(TimeHistogram::bin_of(100) + 1);
  const double of_5000 = TimeHistogram::beginning_of(TimeHistogram::bin_of(5000) + 1);
  EXPECT_EQ(histogram.percentile(0.5), of_100);
  EXPECT_EQ(histogram.percentile(0.999), of_100);
  EXPECT_EQ(histogram.percentile(0.9999), of_5000);
}

// The motions of bench --speed have the properties that they claim.

IndexedMesh star() { return with_index(mesh_of(make_star_bumps(2.0))); }

TEST(Trajectories, APressedToolIsHeldBackInEveryCycle) {
  const IndexedMesh on = star();
  const MotionKind kind{.clearance = 0.5, .shortest = 0.1, .longest = 0.3};
  const std::vector<Motion> motions = pressed_motions(on, 400, kind, Random(1));
  ASSERT_EQ(motions.size(), 400u);
  MotionConstraint guard = certified(queried(on), kind.clearance);
  NearestTriangle nearest(*on.mesh, *on.index);
  for (const Motion& motion : motions) {
    EXPECT_EQ(guard.step(motion).status, Status::limited);
    EXPECT_GE(motion.desired.norm(), kind.shortest * (1.0 - 1e-12));
    EXPECT_LE(motion.desired.norm(), kind.longest);
    EXPECT_GE(nearest(motion.tip).closest.distance, kind.clearance * (1.0 - 1e-6));
  }
}

TEST(Trajectories, AFreeToolIsNeverHeldBackAndStaysOnItsPath) {
  const IndexedMesh on = star();
  const FreeSpace space{.nearest = 2.0, .farthest = 20.0};
  const std::vector<Motion> motions = free_motions(on, 5000, space, {.clearance = 0.2}, Random(2));
  ASSERT_EQ(motions.size(), 5000u);
  MotionConstraint guard = certified(queried(on), 0.2);
  NearestTriangle nearest(*on.mesh, *on.index);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    EXPECT_EQ(guard.step(motions[i]).status, Status::free);
    const double distance = nearest(motions[i].tip).closest.distance;
    EXPECT_GE(distance, space.nearest);
    EXPECT_LE(distance, space.farthest);
    if (i == 0) continue;
    EXPECT_EQ(motions[i].tip, motions[i - 1].tip + motions[i - 1].desired);
  }
}

TEST(Trajectories, OfAPlannerAreHeldBackEachTime) {
  const IndexedMesh on = star();
  const std::vector<Motion> motions = held_back_motions(on, 300, {}, Random(4));
  ASSERT_EQ(motions.size(), 300u);
  MotionConstraint guard = certified(queried(on), MotionKind{}.clearance);
  for (const Motion& motion : motions) EXPECT_EQ(guard.step(motion).status, Status::limited);
}

TEST(Disagreement, IsToldOfAnyBitOfAStepAndOfNothingElse) {
  const IndexedMesh on = star();
  const std::vector<Motion> motions = pressed_motions(on, 400, {.clearance = 0.5}, Random(5));
  MotionConstraint ours = certified(on, 0.5), plain = certified(queried(on), 0.5);
  EXPECT_EQ(disagreement(ours, plain, motions), "");
  MotionConstraint other = certified(on, 0.5 * (1.0 + 1e-15));
  EXPECT_CONTAINS(disagreement(ours, other, motions), "not timed: ");
  EXPECT_EQ(disagreement(ours, other, motions, 1e-9), "");
}

TEST(Trajectories, SayWhereThereIsNoSuchSpace) {
  // No place inside a sphere of radius 50 is that far from it.
  const IndexedMesh on = with_index(mesh_of(make_concave_sphere(10.0)));
  EXPECT_THROW(free_motions(on, 10, {.nearest = 60.0, .farthest = 70.0}, {}, Random(3)), Error);
}

}  // namespace
}  // namespace keepout::app
