// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_record.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {
namespace {

/// The smallest value that at least the given part of the values does not exceed.
double nearest_rank(const std::vector<float>& sorted, double part) {
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return static_cast<double>(sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1]);
}

void add_step_times(const Run& run, RunSummary& summary) {
  std::vector<float> times;
  times.reserve(summary.cycles);
  for (const Stroke& stroke : run.strokes) {
    for (const Cycle& cycle : stroke.cycles) times.push_back(cycle.step_us);
  }
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  summary.p50_us = nearest_rank(times, 0.50);
  summary.p99_us = nearest_rank(times, 0.99);
  summary.p999_us = nearest_rank(times, 0.999);
  summary.max_us = static_cast<double>(times.back());
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
      switch (cycle.outcome) {
        case Outcome::moved_freely:
          ++summary.moved_freely;
          break;
        case Outcome::limited:
          ++summary.limited;
          break;
        case Outcome::stopped:
          ++summary.stopped;
          break;
      }
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

std::vector<bool> trespass(const Run& run, std::size_t stroke, SurfaceKind surface) {
  const std::vector<Cycle>& cycles = run.strokes.at(stroke).cycles;
  std::vector<bool> result(cycles.size(), false);
  if (surface == SurfaceKind::closed) {
    for (std::size_t i = 0; i < cycles.size(); ++i) result[i] = !(cycles[i].clearance >= 0.0);
    return result;
  }
  for (const Crossing& crossing : run.crossings) {
    if (crossing.stroke != stroke) continue;
    for (std::size_t i = crossing.cycle; i < cycles.size(); ++i) result[i] = !result[i];
  }
  return result;
}

}  // namespace keepout::app
