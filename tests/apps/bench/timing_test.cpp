// SPDX-FileCopyrightText: 2026 the keepout authors
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

TEST(Timing, OfOneSampleIsThatSample) {
  std::vector<double> one = {7.0};
  const Timing timing = timing_of(one);
  EXPECT_EQ(timing.p50, 7.0);
  EXPECT_EQ(timing.max, 7.0);
}

}  // namespace
}  // namespace keepout::app
