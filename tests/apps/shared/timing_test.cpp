// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bench/benchmark.h"

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

}  // namespace
}  // namespace keepout::app
