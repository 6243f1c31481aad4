// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/speed/speed_record.h"

namespace keepout::app {

using SpeedClock = std::chrono::steady_clock;

inline double microseconds_since(SpeedClock::time_point start) {
  return std::chrono::duration<double, std::micro>(SpeedClock::now() - start).count();
}

/// The least of each percentile over several passes of the same work: what else the machine did
/// meanwhile only ever adds.
class Passes {
 public:
  /// Sorts the samples. [us] Precondition: there is one.
  void add(std::vector<double>& samples);
  const Timing& least() const { return *least_; }

 private:
  std::optional<Timing> least_;
};

/// Below it, reading the clock would be a good part of a time. [us]
inline constexpr double worth_batching = 0.2;
inline constexpr std::size_t batch_length = 32;

/// What takes longer is not repeated. [us]
inline constexpr double patience = 5e6;

/// Times do_one(0) ... do_one(count - 1), one after the other, so many times over, or once if it
/// takes long.
template <class Work>
MeasuredSide timed(std::string name, std::size_t count, int passes, Work&& do_one) {
  Passes single;
  std::vector<double> samples;
  samples.reserve(count);
  const SpeedClock::time_point begin = SpeedClock::now();
  for (int pass = 0; pass < passes && (pass == 0 || microseconds_since(begin) < patience); ++pass) {
    samples.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const SpeedClock::time_point start = SpeedClock::now();
      do_one(i);
      samples.push_back(microseconds_since(start));
    }
    single.add(samples);
  }
  MeasuredSide side{.name = std::move(name), .us = single.least()};
  if (side.us.p50 >= worth_batching || count < batch_length) return side;

  Passes batched;
  for (int pass = 0; pass < passes; ++pass) {
    samples.clear();
    for (std::size_t first = 0; first + batch_length <= count; first += batch_length) {
      const SpeedClock::time_point start = SpeedClock::now();
      for (std::size_t i = first; i < first + batch_length; ++i) do_one(i);
      samples.push_back(microseconds_since(start) / batch_length);
    }
    batched.add(samples);
  }
  side.us.p50 = batched.least().p50;
  side.batch = batch_length;
  return side;
}

/// How long the work takes as a whole: the median of so many times.
template <class Work>
MeasuredSide timed_whole(std::string name, std::size_t times, Work&& work) {
  return timed(std::move(name), times, 1, [&](std::size_t) { work(); });
}

}  // namespace keepout::app
