// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/time_histogram.h"

#include <gtest/gtest.h>

#include <cmath>

#include "keepout/fixtures/random.h"

namespace keepout::app {
namespace {

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
