// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/speed/certified_contact.h"
#include "bench/speed/counted_calls.h"
#include "bench/speed/families.h"
#include "bench/speed/stopwatch.h"
#include "number_text.h"

namespace keepout::app {
namespace {

std::uint64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
}

std::uint64_t nanoseconds(SpeedClock::duration duration) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count());
}

/// Does it so many times; the clock is read once each time.
template <class Work>
void fill(TimeHistogram& histogram, std::size_t times, Work&& work) {
  SpeedClock::time_point last = SpeedClock::now();
  for (std::size_t i = 0; i < times; ++i) {
    work(i, last);
    const SpeedClock::time_point now = SpeedClock::now();
    histogram.add(nanoseconds(now - last));
    last = now;
  }
}

void add_count(SpeedRun& run, const std::string& what, std::uint64_t count, std::size_t steps) {
  run.add({.work = "certified in contact, " + grouped(steps) + " steps after warm-up",
           .compared = what,
           .demand = at_most(0.0),
           .unit = "",
           .figure = static_cast<double>(count)});
}

}  // namespace

void measure_steadiness(SpeedRun& run, const IndexedMesh& on) {
  run.show("histogram");
  const std::vector<Motion> motions = contact_motions_of(run, on, {});
  const std::size_t steps = run.settings.histogram_steps;
  Stepper ours = certified(on, small_margin, Form::searching);
  for (const Motion& motion : motions) ours.ask(motion);

  StepHistogram histogram;
  const std::uint64_t faults = page_faults();
  const CallCounts calls = calls_of_this_thread();
  fill(histogram.steps, steps,
       [&](std::size_t i, SpeedClock::time_point) { ours.ask(motions[i % motions.size()]); });
  const CallCounts calls_after = calls_of_this_thread();
  add_count(run, "page faults", page_faults() - faults, steps);
  if (counts_calls()) {
    add_count(run, "allocations", calls_after.allocations - calls.allocations, steps);
    add_count(run, "locks", calls_after.locks - calls.locks, steps);
  }

  // Nothing but waiting, as often and as long as the median step: what it shows beyond that is the
  // machine's doing.
  const auto median = std::chrono::nanoseconds(
      static_cast<std::int64_t>(histogram.steps.percentile(0.5).value_or(0.0)));
  fill(histogram.nothing, steps, [&](std::size_t, SpeedClock::time_point last) {
    while (SpeedClock::now() - last < median) {
    }
  });
  run.record.histogram = histogram;
}

}  // namespace keepout::app
