// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/names.h"
#include "shared/number_text.h"
#include "simulate/audit.h"

namespace keepout::app {
namespace {

bool has_fixture(const Run& run) { return run.rule != no_rule; }

/// "1.2 mm deep, in 3 of 24 strokes": what a run did to the anatomy. Precondition: it got in.
std::string harm(const RunSummary& summary, SurfaceKind surface) {
  const std::string strokes =
      "in " + grouped(summary.strokes_breached) + " of " + counted(summary.strokes, "stroke");
  if (surface == SurfaceKind::open) {
    return "through the surface " + how_often(summary.crossings) + ", " + strokes;
  }
  if (summary.cycles_inside == 0) {
    return "right through the anatomy within a single cycle, " + strokes;
  }
  return "up to " + length_text(summary.deepest_penetration) + " deep, " + strokes;
}

/// How near a tool came that stayed outside; goes on where a sentence has said that it did.
std::string nearness(double closest) {
  return touches(closest) ? " but touched the surface"
                          : ", never nearer than " + length_text(closest);
}

/// The names of rules are code to us, but odd words in a sentence: they get quotation marks.
std::string quoted(const Run& run) { return "“" + display_name(run) + "”"; }

struct Sorted {
  std::vector<std::string> kept_out, let_in;
};

Sorted sort_rules(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  Sorted sorted;
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    if (!has_fixture(simulation.runs[r])) continue;
    (summaries[r].kept_out() ? sorted.kept_out : sorted.let_in)
        .push_back(quoted(simulation.runs[r]));
  }
  return sorted;
}

}  // namespace

bool touches(double clearance) { return std::abs(clearance) <= Audit::touching; }

std::string display_name(const Run& run) { return has_fixture(run) ? run.rule : "no fixture"; }

std::string explanation(const Run& run) {
  if (!run.description.empty() || has_fixture(run)) return run.description;
  return "the tool goes where the hand goes";
}

std::string subject(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  const RunSummary& first = summaries.front();
  return "A simulated hand pushed a tool over and into " + simulation.mesh_name + " (" +
         counted(simulation.mesh->triangle_count(), "triangle") +
         "): " + counted(first.strokes, "stroke") + ", " + counted(first.cycles, "cycle") +
         " of 1 ms, without a fixture and under " + counted(summaries.size() - 1, "rule") +
         ", margin " + length_text(simulation.margin);
}

std::string headline(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  const auto [kept_out, let_in] = sort_rules(simulation, summaries);
  if (kept_out.empty() && let_in.empty()) return "The tool moved without any fixture.";
  const bool closed = simulation.surface == SurfaceKind::closed;
  const auto rules = [](const std::vector<std::string>& names) {
    return (names.size() == 1 ? "rule " : "rules ") + listed(names);
  };
  std::string text;
  if (let_in.empty()) {
    text = rules(kept_out) + " kept the tool " +
           (closed ? "out of the anatomy." : "from passing through the surface.");
  } else {
    text = rules(let_in) + " let the tool " + (closed ? "into the anatomy" : "through the surface");
    text +=
        kept_out.empty() ? "." : "; " + listed(kept_out) + (closed ? " kept it out." : " did not.");
  }
  text.front() = 'R';
  return text;
}

std::string account(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  std::string text;
  bool tested = true;
  std::vector<std::string> kept_out;
  std::size_t cycles = 0;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    const RunSummary& summary = summaries[r];
    const std::string name = quoted(simulation.runs[r]);
    if (!has_fixture(simulation.runs[r])) {
      tested = !summary.kept_out();
      text +=
          tested ? "Without a fixture the tool went " + harm(summary, simulation.surface) + ". "
                 : "Without a fixture the tool stayed outside too, so these strokes put no rule to "
                   "the test. ";
    } else if (summary.kept_out()) {
      kept_out.push_back(name);
      cycles = summary.cycles;
      closest = std::min(closest, summary.closest_approach);
    } else {
      text += "Under " + name + " it went " + harm(summary, simulation.surface) + ". ";
    }
  }
  if (!kept_out.empty()) {
    text += "Under " + listed(kept_out) + " it stayed outside in all " + counted(cycles, "cycle") +
            nearness(closest) + ". ";
  }
  if (!text.empty()) text.pop_back();
  return text;
}

std::string step_times(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  std::vector<std::string> times;
  for (std::size_t r = 0; r < summaries.size(); ++r) {
    if (summaries[r].p50_us <= 0.0) continue;
    times.push_back(time_text(summaries[r].p50_us) + " under " + quoted(simulation.runs[r]));
  }
  return times.empty() ? "" : "Half of the steps took at most " + listed(times) + ".";
}

std::string outcome_of(const RunSummary& summary, SurfaceKind surface) {
  if (!summary.kept_out()) return "went " + harm(summary, surface);
  std::string text = "stayed outside" + nearness(summary.closest_approach);
  if (summary.stopped > 0) text += "; stood still in " + counted(summary.stopped, "cycle");
  return text;
}

}  // namespace keepout::app
