// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bench/speed/speed.h"
#include "keepout/fixtures/random.h"

namespace keepout::app {
namespace {

/// count, ..., 2, 1.
std::vector<double> countdown(std::size_t count) {
  std::vector<double> samples;
  for (std::size_t i = count; i > 0; --i) samples.push_back(static_cast<double>(i));
  return samples;
}

TEST(Timing, IsByNearestRank) {
  std::vector<double> samples = countdown(1000);
  const Timing timing = timing_of(samples);
  EXPECT_EQ(timing.p50, 500.0);
  EXPECT_EQ(timing.p99, 990.0);
  EXPECT_EQ(timing.p999, 999.0);
  EXPECT_EQ(timing.max, 1000.0);
  EXPECT_EQ(timing.samples, 1000u);
}

TEST(Timing, LeavesOutWhatTooFewSamplesCannotTell) {
  std::vector<double> few = countdown(99);
  EXPECT_EQ(timing_of(few).p99, std::nullopt);
  std::vector<double> some = countdown(999);
  EXPECT_EQ(timing_of(some).p99, 990.0);
  EXPECT_EQ(timing_of(some).p999, std::nullopt);
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

TEST(Timing, OfOneSampleIsThatSample) {
  std::vector<double> one = {7.0};
  const Timing timing = timing_of(one);
  EXPECT_EQ(timing.p50, 7.0);
  EXPECT_EQ(timing.max, 7.0);
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

}  // namespace
}  // namespace keepout::app
