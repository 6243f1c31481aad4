// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulation.h"

#include <algorithm>
#include <limits>
#include <ostream>

#include "shared/number_text.h"
#include "shared/timing.h"

namespace keepout::app {
namespace {

void add_step_times(const Run& run, RunSummary& summary) {
  std::vector<double> times;
  times.reserve(summary.cycles);
  for (const Stroke& stroke : run.strokes) {
    for (const Cycle& cycle : stroke.cycles) times.push_back(cycle.step_us);
  }
  if (times.empty()) return;
  const Timing timing = timing_of(times);
  summary.p50_us = timing.p50;
  summary.max_us = timing.max;
  // Of so few that it is missing the rank is that of the last.
  summary.p99_us = timing.p99.value_or(timing.max);
  summary.p999_us = timing.p999.value_or(timing.max);
  if (summary.p50_us > 0.0) summary.rate_khz = 1000.0 / summary.p50_us;
}

}  // namespace

RunSummary summarize(const Run& run) {
  RunSummary summary;
  summary.strokes = run.strokes.size();
  summary.crossings = run.crossings.size();

  std::vector<bool> breached(run.strokes.size(), false);
  for (const Crossing& crossing : run.crossings) breached.at(crossing.stroke) = true;

  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < run.strokes.size(); ++s) {
    std::size_t inside = 0;
    for (const Cycle& cycle : run.strokes[s].cycles) {
      ++summary.cycles;
      lowest = std::min(lowest, cycle.clearance);
      // A clearance that is not a number proves nothing, so it counts against the rule.
      if (!(cycle.clearance >= 0.0)) ++inside;
      summary.moved_freely += cycle.outcome == Outcome::moved_freely;
      summary.limited += cycle.outcome == Outcome::limited;
      summary.stopped += cycle.outcome == Outcome::stopped;
    }
    summary.cycles_inside += inside;
    if (inside > 0) {
      ++summary.strokes_inside;
      breached[s] = true;
    }
  }
  summary.strokes_breached =
      static_cast<std::size_t>(std::count(breached.begin(), breached.end(), true));

  if (summary.cycles > 0) {
    summary.closest_approach = summary.kept_out() ? lowest : 0.0;
    summary.deepest_penetration = lowest < 0.0 ? -lowest : 0.0;
  }
  add_step_times(run, summary);
  return summary;
}

void print_table(std::ostream& out, const Simulation& simulation) {
  out << formatted("%-10s %8s %9s %9s %9s %12s %12s %8s %10s %9s\n", "rule", "cycles", "kHz",
                   "p50 us", "p99 us", "closest mm", "deepest mm", "inside", "crossings",
                   "stopped");
  const bool closed = simulation.surface == SurfaceKind::closed;  // an open one has no inside
  for (const Run& run : simulation.runs) {
    const RunSummary s = summarize(run);
    // Without a fixture there is no step to be timed.
    const auto time = [&](double value, int decimals) {
      return s.max_us > 0.0 ? formatted("%.*f", decimals, value) : "-";
    };
    out << formatted(
        "%-10s %8zu %9s %9s %9s %12.4f %12s %8s %10zu %9zu\n", run.rule.c_str(), s.cycles,
        time(s.rate_khz, 1).c_str(), time(s.p50_us, 2).c_str(), time(s.p99_us, 2).c_str(),
        s.closest_approach, closed ? formatted("%.4f", s.deepest_penetration).c_str() : "-",
        closed ? std::to_string(s.cycles_inside).c_str() : "-", s.crossings, s.stopped);
  }
}

}  // namespace keepout::app
