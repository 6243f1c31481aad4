// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "bench/speed/stopwatch.h"

namespace keepout::app {
namespace {

/// Puts other data into every cache, by passing over more than they hold.
class Eviction {
 public:
  Eviction() : bytes_(size()) {}

  void operator()() {
    constexpr std::size_t line = 64;
    for (std::size_t i = 0; i < bytes_.size(); i += line) ++bytes_[i];
  }

 private:
  /// Twice the last cache. What a virtual machine tells of it may be the whole machine's.
  static std::size_t size() {
    constexpr long least = 64L << 20, most = 256L << 20;
    return static_cast<std::size_t>(std::clamp(2 * sysconf(_SC_LEVEL3_CACHE_SIZE), least, most));
  }

  std::vector<unsigned char> bytes_;
};

}  // namespace

void measure_cold_caches(SpeedRun& run, const IndexedMesh& on) {
  run.show("certified, cold caches");
  std::vector<Motion> motions = contact_motions_of(run, on, {});
  motions.resize(std::min(motions.size(), run.settings.effort.cold_steps));
  Stepper ours = certified(on, small_margin, Form::searching);
  for (const Motion& motion : motions) ours.ask(motion);
  Eviction evict;
  std::vector<double> times;
  for (const Motion& motion : motions) {
    evict();
    const SpeedClock::time_point start = SpeedClock::now();
    ours.ask(motion);
    times.push_back(microseconds_since(start));
  }
  const MeasuredSide cold{.name = "cold", .us = timing_of(times)};
  SpeedRow row{.work = "certified in contact, caches emptied before each step",
               .compared = "p99 / warm median",
               .demand = at_most(40.0),
               .sides = {cold}};
  if (run.baselines.contact && cold.us.p99) {
    row.figure = *cold.us.p99 / run.baselines.contact->us.p50;
    row.sides.push_back(*run.baselines.contact);
  }
  run.add(std::move(row));
}

}  // namespace keepout::app
