// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "keepout/error.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "record/record.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "simulate/simulation.h"

namespace keepout::app {
namespace {

bool has_fixture(const Run& run) { return run.rule != no_rule; }

/// The name of a run as a reader sees it.
std::string display_name(const Run& run) { return has_fixture(run) ? run.rule : "no fixture"; }

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

/// One line on what the rule does; empty where the run says nothing.
std::string explanation(const Run& run) {
  if (!run.description.empty() || has_fixture(run)) return run.description;
  return "the tool goes where the hand goes";
}

/// Returns a sentence on the mesh, the strokes and the cycles.
std::string subject(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  const RunSummary& first = summaries.front();
  return "A simulated hand pushed a tool over and into " + simulation.mesh_name + " (" +
         counted(simulation.mesh->triangle_count(), "triangle") +
         "): " + counted(first.strokes, "stroke") + ", " + counted(first.cycles, "cycle") +
         " of 1 ms, without a fixture and under " + counted(summaries.size() - 1, "rule") +
         ", margin " + length_text(simulation.margin);
}

/// The one sentence at the top: which rules kept the tool out, and which did not.
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

/// The sentences below it: how deep, how often, out of how many.
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

/// How long half of the steps took under each rule; empty where none was timed.
std::string step_times(const Simulation& simulation, const std::vector<RunSummary>& summaries) {
  std::vector<std::string> times;
  for (std::size_t r = 0; r < summaries.size(); ++r) {
    if (summaries[r].p50_us <= 0.0) continue;
    times.push_back(time_text(summaries[r].p50_us) + " under " + quoted(simulation.runs[r]));
  }
  return times.empty() ? "" : "Half of the steps took at most " + listed(times) + ".";
}

double clearance_at(const Run& run, const Moment& moment) {
  return run.strokes[moment.stroke].cycles[moment.cycle].clearance;
}

/// The deepest penetration of a run, or else its first crossing, or else its nearest approach.
Moment worst_moment(const Run& run) {
  Moment worst;
  for (std::size_t s = 0; s < run.strokes.size(); ++s) {
    for (std::size_t c = 0; c < run.strokes[s].cycles.size(); ++c) {
      if (clearance_at(run, {s, c}) < clearance_at(run, worst)) worst = {s, c};
    }
  }
  const bool is_outside = clearance_at(run, worst) >= 0.0;
  return is_outside && !run.crossings.empty() ? run.crossings.front() : worst;
}

/// The run and the moment that tell most about the rules: the deepest penetration that a rule let
/// happen, or else a crossing, or else, as no rule failed, the worst of the run without a fixture.
std::pair<std::size_t, Moment> telling_moment(const Simulation& simulation) {
  // A rule that failed tells most, then what the fixture is for, then how near a rule came.
  const auto rank = [](const Run& run) {
    const double clearance = clearance_at(run, worst_moment(run));
    const int kind = clearance >= 0.0 && run.crossings.empty() ? 0 : has_fixture(run) ? 2 : 1;
    return std::pair(kind, -clearance);
  };
  const auto run = std::ranges::max_element(simulation.runs, {}, rank);
  return {run - simulation.runs.begin(), worst_moment(*run)};
}

Json moment_json(const Moment& moment) {
  return {{"stroke", moment.stroke}, {"cycle", moment.cycle}};
}

void check(const Simulation& simulation) {
  if (simulation.mesh == nullptr || simulation.runs.empty()) {
    throw Error("nothing to report: there is no mesh, or no run");
  }
  for (const Run& run : simulation.runs) {
    if (run.strokes.empty() || run.strokes.size() != simulation.runs.front().strokes.size() ||
        std::ranges::any_of(run.strokes,
                            [](const Stroke& stroke) { return stroke.cycles.empty(); })) {
      throw Error("cannot report on rule " + run.rule +
                  ": it lacks strokes that other rules have, or cycles in a stroke");
    }
  }
}

/// Rounds a number of a cycle to the digits that records have.
double to_digits(double value, double parts_of_one) {
  return std::round(value * parts_of_one) / parts_of_one;
}
double length(double mm) { return to_digits(mm, 1e6); }

Json place(const Vec3& point) { return {length(point.x()), length(point.y()), length(point.z())}; }

Json record_of(const Stroke& stroke) {
  Json tips = Json::array(), clearances = Json::array(), times = Json::array();
  std::string outcomes;
  for (const Cycle& cycle : stroke.cycles) {
    tips.push_back(place(cycle.tip));
    clearances.push_back(length(cycle.clearance));
    times.push_back(to_digits(static_cast<double>(cycle.step_us), 1e3));
    outcomes += "fls"[static_cast<int>(cycle.outcome)];
  }
  return {{"tip", std::move(tips)},
          {"clearance_mm", std::move(clearances)},
          {"step_us", std::move(times)},
          {"outcome", std::move(outcomes)}};
}

Json run_json(const Simulation& simulation, std::size_t number, const RunSummary& summary) {
  const Run& run = simulation.runs[number];
  Json strokes = Json::array(), crossings = Json::array();
  for (const Stroke& stroke : run.strokes) strokes.push_back(record_of(stroke));
  for (const Moment& crossing : run.crossings) crossings.push_back(moment_json(crossing));
  return {{"rule", run.rule},
          {"name", display_name(run)},
          {"description", explanation(run)},
          {"kept_out", summary.kept_out()},
          {"words", outcome_of(summary, simulation.surface)},
          {"summary", json_of(summary, simulation.surface)},
          {"worst", moment_json(worst_moment(run))},
          {"strokes", std::move(strokes)},
          {"crossings", std::move(crossings)}};
}

Json hands_of(const Run& run) {
  Json hands = Json::array();
  for (const Stroke& stroke : run.strokes) {
    Json& hand = hands.emplace_back(Json::array());
    for (const Cycle& cycle : stroke.cycles) hand.push_back(place(cycle.hand));
  }
  return hands;
}

/// Returns the bounds of the tips of all runs in a stroke, enlarged by half on all sides.
Box around(const Simulation& simulation, std::size_t stroke) {
  const Vec3 first = simulation.runs.front().strokes[stroke].cycles.front().tip;
  Box box{first, first};
  for (const Run& run : simulation.runs) {
    for (const Cycle& cycle : run.strokes[stroke].cycles) {
      box = {box.low.cwiseMin(cycle.tip), box.high.cwiseMax(cycle.tip)};
    }
  }
  const Vec3 far = Vec3::Constant(0.5 * box.size().norm());
  return {box.low - far, box.high + far};
}

}  // namespace

std::string outcome_of(const RunSummary& summary, SurfaceKind surface) {
  if (!summary.kept_out()) return "went " + harm(summary, surface);
  std::string text = "stayed outside" + nearness(summary.closest_approach);
  if (summary.stopped > 0) text += "; stood still in " + counted(summary.stopped, "cycle");
  return text;
}

Json record_of(const Simulation& simulation) {
  check(simulation);
  std::vector<RunSummary> summaries;
  for (const Run& run : simulation.runs) summaries.push_back(summarize(run));
  RecordHead head{.kind = "simulate",
                  .command = simulation.command,
                  .subject = subject(simulation, summaries),
                  .headline = headline(simulation, summaries),
                  .account = {account(simulation, summaries)},
                  .machine = this_machine(),
                  .settings = simulation.settings};
  if (std::string times = step_times(simulation, summaries); !times.empty()) {
    head.account.push_back(std::move(times));
  }
  Json record = new_record(head);
  const auto [told, moment] = telling_moment(simulation);
  Json& mesh = record["mesh"] =
      drawn_mesh(simulation.mesh_name, *simulation.mesh, around(simulation, moment.stroke));
  mesh["surface"] = simulation.surface == SurfaceKind::closed ? "closed" : "open";
  record["kept_mm"] = simulation.margin;
  record["cycle_s"] = simulation.cycle_seconds;
  record["up"] = json_of(simulation.up);
  record["moment"] = {{"run", told}, {"stroke", moment.stroke}, {"cycle", moment.cycle}};
  record["hand"] = hands_of(simulation.runs.front());
  Json& runs = record["runs"] = Json::array();
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    runs.push_back(run_json(simulation, r, summaries[r]));
  }
  for (const char* part : {"comparison", "benchmark"}) record[part] = nullptr;
  return record;
}

}  // namespace keepout::app
