// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

namespace keepout::app {

/// The clock of all measured times.
using BenchClock = std::chrono::steady_clock;

inline double microseconds_since(BenchClock::time_point start) {
  return std::chrono::duration<double, std::micro>(BenchClock::now() - start).count();
}

/// Statistics of repeated times. Percentiles are by nearest rank, so each is a measured time. A
/// percentile that needs more samples than there are is empty. [µs]
struct Timing {
  double p50 = 0.0;
  std::optional<double> p99 = {};   // needs at least 100 samples
  std::optional<double> p999 = {};  // needs at least 1000 samples
  double max = 0.0;
  std::size_t samples = 0;
};

/// Sorts the samples and returns their statistics; zeros without samples. [µs]
Timing timing_of(std::vector<double>& samples);

/// Any number of times, in bounded memory: beyond a million it keeps every second time, then every
/// fourth, and so on.
class Times {
 public:
  void add(double us);

  /// The longest of all times, and percentiles of those that are kept.
  Timing timing() const;

 private:
  std::vector<double> kept_;  // [us]
  std::size_t count_ = 0;     // of all
  std::size_t every_ = 1;     // one in so many is kept
  double longest_ = 0.0;      // [us]
};

}  // namespace keepout::app
