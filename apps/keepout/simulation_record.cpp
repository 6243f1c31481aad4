// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_record.h"

#include <algorithm>
#include <limits>
#include <ostream>
#include <sstream>

#include "bench/timing.h"
#include "number_text.h"
#include "report/text.h"
#include "report/verdict.h"

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

/// Not bytes: our texts are in UTF-8.
std::size_t characters_in(const std::string& word) {
  std::size_t width = 0;
  for (const char c : word) width += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return width;
}

/// In lines that fit a terminal.
void print_wrapped(std::ostream& out, const std::string& text) {
  constexpr std::size_t longest = 88;
  std::istringstream words(text);
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    const std::size_t more = characters_in(word);
    if (width > 0) {
      const bool fits = width + 1 + more <= longest;
      out << (fits ? ' ' : '\n');
      width = fits ? width + 1 : 0;
    }
    out << word;
    width += more;
  }
  out << '\n';
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

void print_summary(std::ostream& out, const Simulation& simulation) {
  std::vector<RunSummary> summaries;
  for (const Run& run : simulation.runs) summaries.push_back(summarize(run));
  const RunSummary& first = summaries.front();
  print_wrapped(out, "A simulated hand pushed a tool over and into " + simulation.mesh_name + " (" +
                         counted(simulation.mesh->triangle_count(), "triangle") +
                         "): " + counted(first.strokes, "stroke") + ", " +
                         counted(first.cycles, "cycle") + " of 1 ms, without a fixture and under " +
                         counted(summaries.size() - 1, "rule") + ", margin " +
                         length_text(simulation.margin) + ".");
  out << '\n';
  print_wrapped(out, headline(simulation, summaries));
  print_wrapped(out, account(simulation, summaries));
  std::vector<std::string> times;
  for (std::size_t r = 0; r < summaries.size(); ++r) {
    if (summaries[r].p50_us <= 0.0) continue;
    times.push_back(time_text(summaries[r].p50_us) + " under “" + display_name(simulation.runs[r]) +
                    "”");
  }
  if (!times.empty()) print_wrapped(out, "Half of the steps took at most " + listed(times) + ".");
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
