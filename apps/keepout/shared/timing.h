// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
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

/// The lesser of each percentile of two passes over the same work: what else the machine did
/// meanwhile only ever adds.
Timing least_of(const Timing& one, const Timing& other);

/// What was timed under one name. The median of what takes less than 0.2 us is that of batches,
/// each divided by its length, for reading the clock would be a good part of it; the percentiles
/// beside it are of single ones, the clock's reading included.
struct MeasuredSide {
  std::string name = {};
  Timing us = {};
  std::size_t batch = 1;  // how many were timed at once, for the median
};

/// Times do_one(0) ... do_one(count - 1), one after the other, in batches of so many, so many times
/// over, or once if it takes long: the least of each percentile. Precondition: batch <= count.
template <class Work>
Timing timed_in_batches(std::size_t batch, std::size_t count, int passes, Work&& do_one) {
  constexpr double patience = 5e6;  // what takes longer is not repeated [us]
  std::optional<Timing> least;
  std::vector<double> samples;
  samples.reserve(count / batch);
  const BenchClock::time_point begin = BenchClock::now();
  for (int pass = 0; pass < passes && (pass == 0 || microseconds_since(begin) < patience); ++pass) {
    samples.clear();
    for (std::size_t first = 0; first + batch <= count; first += batch) {
      const BenchClock::time_point start = BenchClock::now();
      for (std::size_t i = first; i < first + batch; ++i) do_one(i);
      samples.push_back(microseconds_since(start) / static_cast<double>(batch));
    }
    const Timing timing = timing_of(samples);
    least = least ? least_of(*least, timing) : timing;
  }
  return *least;
}

/// The same one by one, and the median of what is too short for that in batches.
template <class Work>
MeasuredSide timed(std::string name, std::size_t count, int passes, Work&& do_one) {
  constexpr double worth_batching = 0.2;  // below, reading the clock would be a good part [us]
  constexpr std::size_t batch = 32;
  MeasuredSide side{.name = std::move(name), .us = timed_in_batches(1, count, passes, do_one)};
  if (side.us.p50 >= worth_batching || count < batch) return side;
  side.us.p50 = timed_in_batches(batch, count, passes, do_one).p50;
  side.batch = batch;
  return side;
}

/// How long the work takes as a whole: the median of so many times.
template <class Work>
MeasuredSide timed_whole(std::string name, std::size_t times, Work&& work) {
  return timed(std::move(name), times, 1, [&](std::size_t) { work(); });
}

}  // namespace keepout::app
