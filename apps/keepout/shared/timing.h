// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

namespace keepout::app {

/// By which everything here is timed.
using BenchClock = std::chrono::steady_clock;

inline double microseconds_since(BenchClock::time_point start) {
  return std::chrono::duration<double, std::micro>(BenchClock::now() - start).count();
}

/// How long something took, over many times. [us] Percentiles are by nearest rank: a time that did
/// occur. Those that need more samples than there are, are missing.
struct Timing {
  double p50 = 0.0;
  std::optional<double> p99 = {};   // of 100 samples or more
  std::optional<double> p999 = {};  // of 1000 samples or more
  double max = 0.0;
  std::size_t samples = 0;
};

/// Sorts the samples. [us] All zero where there are none.
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
