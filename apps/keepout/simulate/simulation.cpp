// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "shared/number_text.h"
#include "shared/timing.h"
#include "simulate/audit.h"

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

/// A row of the table: one run.
struct Row {
  std::string rule;
  RunSummary figures;
  SurfaceKind surface;
};

template <class Member>
auto if_timed(Member member) {
  // Without a fixture there is no step to be timed.
  return [=](const Row& row) {
    return row.figures.max_us > 0.0 ? Json(row.figures.*member) : Json(nullptr);
  };
}

template <class Member>
auto if_closed(Member member) {
  // An open surface has no inside.
  return [=](const Row& row) {
    return row.surface == SurfaceKind::closed ? Json(row.figures.*member) : Json(nullptr);
  };
}

template <class Member>
auto always(Member member) {
  return [=](const Row& row) { return Json(row.figures.*member); };
}

Json closest(const Row& row) {
  return touches(row.figures.closest_approach) ? 0.0 : row.figures.closest_approach;
}

template <int decimals>
std::string shown(const Json& value) {
  return value.is_null() ? "-" : formatted("%.*f", decimals, value.get<double>());
}

const Columns<Row>& figure_columns() {
  using S = RunSummary;
  static const Columns<Row> all{
      {"", &Row::rule, "rule", -10},
      {"strokes", always(&S::strokes)},
      {"cycles", always(&S::cycles), "cycles", 8},
      {"rate_khz", if_timed(&S::rate_khz), "kHz", 9, shown<1>},
      {"p50_us", if_timed(&S::p50_us), "p50 us", 9, shown<2>},
      {"p99_us", if_timed(&S::p99_us), "p99 us", 9, shown<2>},
      {"p999_us", if_timed(&S::p999_us)},
      {"max_us", if_timed(&S::max_us)},
      {"closest_approach_mm", closest, "closest mm", 12, shown<4>},
      {"deepest_mm", if_closed(&S::deepest_penetration), "deepest mm", 12, shown<4>},
      {"cycles_inside", if_closed(&S::cycles_inside), "inside", 8, shown<0>},
      {"strokes_inside", if_closed(&S::strokes_inside)},
      {"crossings", always(&S::crossings), "crossings", 10},
      {"strokes_breached", always(&S::strokes_breached)},
      {"moved_freely", always(&S::moved_freely)},
      {"limited", always(&S::limited)},
      {"stopped", always(&S::stopped), "stopped", 9}};
  return all;
}

}  // namespace

bool touches(double clearance) { return std::abs(clearance) <= Audit::touching; }

RunSummary summarize(const Run& run) {
  RunSummary summary;
  summary.strokes = run.strokes.size();
  summary.crossings = run.crossings.size();

  std::vector<bool> breached(run.strokes.size(), false);
  for (const Moment& crossing : run.crossings) breached.at(crossing.stroke) = true;

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

Json json_of(const RunSummary& summary, SurfaceKind surface) {
  return json_of(figure_columns(), Row{{}, summary, surface});
}

void print_table(std::ostream& out, const Simulation& simulation) {
  std::vector<Row> rows;
  for (const Run& run : simulation.runs) {
    rows.push_back({run.rule, summarize(run), simulation.surface});
  }
  print_rows(out, figure_columns(), rows);
}

}  // namespace keepout::app
