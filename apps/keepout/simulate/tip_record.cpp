// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/tip_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

/// One cycle of a run.
struct Moment {
  std::size_t stroke = 0;
  std::size_t cycle = 0;
};

Json moment_json(const Moment& moment) {
  return {{"stroke", moment.stroke}, {"cycle", moment.cycle}};
}

/// Returns true if a tip at this distance from the surface touches it, as far as the check can
/// tell. [mm]
bool touches(double clearance) { return std::abs(clearance) <= Audit::touching; }

/// 0 if the tip has been inside, or has crossed. [mm]
double closest(const RunTally& tally) {
  return !tally.kept_out() || touches(tally.least) ? 0.0 : tally.least;
}

/// The names of rules are code to us, but odd words in a sentence: they get quotation marks.
std::string quoted(const std::string& rule) { return "“" + rule + "”"; }

std::string display_name(const std::string& rule) { return rule == no_rule ? "no fixture" : rule; }

/// Returns a sentence on the mesh, the strokes and the cycles.
std::string subject(const TipSimulation& simulation, const std::vector<RunTally>& tallies) {
  const RunTally& first = tallies.front();
  return "A simulated hand pushed a tool over and into " + simulation.mesh_name + " (" +
         counted(simulation.mesh->triangle_count(), "triangle") +
         "): " + counted(first.strokes, "stroke") + ", " + counted(first.cycles, "cycle") +
         " of 1 ms, without a fixture and under " + counted(tallies.size() - 1, "rule") +
         ", margin " + length_text(simulation.margin);
}

/// Returns one sentence: which rules kept the tool out, and which did not.
std::string headline(SurfaceKind surface, const std::vector<RunTally>& tallies) {
  std::vector<std::string> kept_out, let_in;
  for (const RunTally& tally : tallies) {
    if (tally.guard == no_rule) continue;
    (tally.kept_out() ? kept_out : let_in).push_back(quoted(tally.guard));
  }
  if (kept_out.empty() && let_in.empty()) return "The tool moved without any fixture.";
  const bool is_closed = surface == SurfaceKind::closed;
  const std::vector<std::string>& first = let_in.empty() ? kept_out : let_in;
  const std::string rules = (first.size() == 1 ? "Rule " : "Rules ") + listed(first);
  if (let_in.empty()) {
    return rules + " kept the tool " +
           (is_closed ? "out of the anatomy." : "from passing through the surface.");
  }
  const std::string let =
      is_closed ? " let the tool into the anatomy" : " let the tool through the surface";
  if (kept_out.empty()) return rules + let + ".";
  return rules + let + "; " + listed(kept_out) + (is_closed ? " kept it out." : " did not.");
}

/// Returns a sentence on each run: how deep, how often, how fast.
std::vector<std::string> account(SurfaceKind surface, const std::vector<RunTally>& tallies) {
  std::vector<std::string> sentences;
  for (const RunTally& tally : tallies) {
    const bool has_rule = tally.guard != no_rule;
    std::string text = has_rule ? "Under " + quoted(tally.guard) : "Without a fixture";
    text += " the tool " + outcome_of(tally, surface);
    if (tally.step.p50 > 0.0) {
      text += "; half of the steps took at most " + time_text(tally.step.p50);
    } else if (!has_rule && tally.kept_out()) {
      text += ", so these strokes put no rule to the test";
    }
    sentences.push_back(text + ".");
  }
  return sentences;
}

const Cycle& cycle_at(const TipSimulation& simulation, std::size_t run, const Moment& moment) {
  return simulation.strokes[moment.stroke].runs[run][moment.cycle];
}

/// The moments of a run that a page shows.
struct Moments {
  Moment
      worst;  // the deepest penetration, or else the first crossing, or else the nearest approach
  std::vector<Moment> crossings = {};
};

Moments moments_of(const TipSimulation& simulation, std::size_t run) {
  Moments moments;
  for (std::size_t s = 0; s < simulation.strokes.size(); ++s) {
    const std::vector<Cycle>& cycles = simulation.strokes[s].runs[run];
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      const double least = cycle_at(simulation, run, moments.worst).least();
      if (cycles[c].least() < least) moments.worst = {s, c};
      if (cycles[c].is_crossing) moments.crossings.push_back({s, c});
    }
  }
  const bool is_outside = cycle_at(simulation, run, moments.worst).least() >= 0.0;
  if (is_outside && !moments.crossings.empty()) moments.worst = moments.crossings.front();
  return moments;
}

/// Returns the run that says most about the rules: the deepest penetration that a rule let happen,
/// or else a crossing, or else, as no rule failed, the run without a fixture.
std::size_t telling_run(const TipSimulation& simulation, const std::vector<Moments>& moments) {
  // A rule that failed tells most, then what the fixture is for, then how near a rule came.
  const auto rank = [&](std::size_t run) {
    const double clearance = cycle_at(simulation, run, moments[run].worst).least();
    const bool is_harmless = clearance >= 0.0 && moments[run].crossings.empty();
    return std::pair(is_harmless ? 0 : simulation.rules[run] == no_rule ? 1 : 2, -clearance);
  };
  std::size_t telling = 0;
  for (std::size_t run = 1; run < moments.size(); ++run) {
    if (rank(run) > rank(telling)) telling = run;
  }
  return telling;
}

/// Rounds a number of a cycle to the digits that records have.
double to_digits(double value, double parts_of_one) {
  return std::round(value * parts_of_one) / parts_of_one;
}
double length(double mm) { return to_digits(mm, 1e6); }

Json place(const Vec3& point) { return {length(point.x()), length(point.y()), length(point.z())}; }

Json stroke_json(const std::vector<Cycle>& cycles) {
  Json tips = Json::array(), clearances = Json::array(), times = Json::array();
  std::string outcomes;
  for (const Cycle& cycle : cycles) {
    tips.push_back(place(cycle.places.front()));
    clearances.push_back(length(cycle.least()));
    times.push_back(to_digits(static_cast<double>(cycle.step_us), 1e3));
    outcomes += "fls"[static_cast<int>(cycle.outcome)];
  }
  return {{"tip", std::move(tips)},
          {"clearance_mm", std::move(clearances)},
          {"step_us", std::move(times)},
          {"outcome", std::move(outcomes)}};
}

Json run_json(const TipSimulation& simulation, std::size_t run, const RunTally& tally,
              const Moments& moments) {
  const std::string& rule = simulation.rules[run];
  Json strokes = Json::array(), crossings = Json::array();
  for (const FollowedStroke& followed : simulation.strokes) {
    strokes.push_back(stroke_json(followed.runs[run]));
  }
  for (const Moment& crossing : moments.crossings) crossings.push_back(moment_json(crossing));
  return {{"rule", rule},
          {"name", display_name(rule)},
          {"description", simulation.descriptions[run]},
          {"kept_out", tally.kept_out()},
          {"words", outcome_of(tally, simulation.surface)},
          {"summary", json_of(tip_columns(simulation.surface), tally)},
          {"worst", moment_json(moments.worst)},
          {"strokes", std::move(strokes)},
          {"crossings", std::move(crossings)}};
}

/// Returns the bounds of the tips of all runs in a stroke, enlarged by half on all sides.
Box around(const FollowedStroke& followed) {
  const Vec3 first = followed.runs.front().front().places.front();
  Box box{first, first};
  for (const std::vector<Cycle>& cycles : followed.runs) {
    for (const Cycle& cycle : cycles) {
      box = {box.low.cwiseMin(cycle.places.front()), box.high.cwiseMax(cycle.places.front())};
    }
  }
  const Vec3 far = Vec3::Constant(0.5 * box.size().norm());
  return {box.low - far, box.high + far};
}

}  // namespace

Columns<RunTally> tip_columns(SurfaceKind surface) {
  // Without a fixture there is no step to be timed.
  const auto timed = [](auto figure) {
    return [=](const RunTally& t) { return t.step.max > 0.0 ? Json(figure(t.step)) : Json(); };
  };
  // An open surface has no inside.
  const auto inside = [surface](auto figure) {
    return
        [=](const RunTally& t) { return surface == SurfaceKind::closed ? Json(figure(t)) : Json(); };
  };
  const auto with = [](Outcome outcome) {
    return [=](const RunTally& t) { return Json(t.with(outcome)); };
  };
  return {
      {"", &RunTally::guard, "rule", -10},
      {"strokes", &RunTally::strokes},
      {"cycles", &RunTally::cycles, "cycles", 8},
      {"rate_khz", timed([](const Timing& t) { return 1000.0 / t.p50; }), "kHz", 9,
       number_text<"%.1f">},
      {"p50_us", timed([](const Timing& t) { return t.p50; }), "p50 us", 9, number_text<"%.2f">},
      // The rank of a percentile that so few steps do not have is that of the last.
      {"p99_us", timed([](const Timing& t) { return t.p99.value_or(t.max); }), "p99 us", 9,
       number_text<"%.2f">},
      {"p999_us", timed([](const Timing& t) { return t.p999.value_or(t.max); })},
      {"max_us", timed([](const Timing& t) { return t.max; })},
      {"closest_approach_mm", closest, "closest mm", 12, number_text<"%.4f">},
      {"deepest_mm", inside([](const RunTally& t) { return t.any.deepest; }), "deepest mm", 12,
       number_text<"%.4f">},
      {"cycles_inside", inside([](const RunTally& t) { return t.any.in_mesh; }), "inside", 8,
       number_text<"%.0f">},
      {"strokes_inside", inside([](const RunTally& t) { return t.strokes_inside; })},
      {"crossings", &RunTally::crossings, "crossings", 10},
      {"strokes_breached", &RunTally::strokes_breached},
      {"moved_freely", with(Outcome::moved_freely)},
      {"limited", with(Outcome::limited)},
      {"stopped", with(Outcome::stopped), "stopped", 9}};
}

std::string outcome_of(const RunTally& tally, SurfaceKind surface) {
  if (tally.kept_out()) {
    std::string text =
        "stayed outside" + (closest(tally) == 0.0
                                ? std::string(" but touched the surface")
                                : ", never nearer than " + length_text(closest(tally)));
    const std::size_t stopped = tally.with(Outcome::stopped);
    return stopped > 0 ? text + "; stood still in " + counted(stopped, "cycle") : text;
  }
  const std::string how =
      surface == SurfaceKind::open ? "through the surface " + how_often(tally.crossings)
      : tally.any.in_mesh == 0     ? "right through the anatomy within a single cycle"
                                   : "up to " + length_text(tally.any.deepest) + " deep";
  return "went " + how + ", in " + grouped(tally.strokes_breached) + " of " +
         counted(tally.strokes, "stroke");
}

Json record_of(const TipSimulation& simulation, const std::vector<RunTally>& tallies) {
  Json record = new_record({.kind = "simulate",
                            .command = simulation.command,
                            .subject = subject(simulation, tallies),
                            .headline = headline(simulation.surface, tallies),
                            .account = account(simulation.surface, tallies),
                            .machine = this_machine(),
                            .settings = simulation.settings});
  std::vector<Moments> moments;
  for (std::size_t run = 0; run < tallies.size(); ++run) {
    moments.push_back(moments_of(simulation, run));
  }
  const std::size_t told = telling_run(simulation, moments);
  const Moment& moment = moments[told].worst;
  Json& mesh = record["mesh"] =
      drawn_mesh(simulation.mesh_name, *simulation.mesh, around(simulation.strokes[moment.stroke]));
  mesh["surface"] = simulation.surface == SurfaceKind::closed ? "closed" : "open";
  record["kept_mm"] = simulation.margin;
  record["cycle_s"] = cycle_seconds;
  record["up"] = {0.0, 0.0, 1.0};  // head-wards in CT data
  record["moment"] = {{"run", told}, {"stroke", moment.stroke}, {"cycle", moment.cycle}};
  Json& hands = record["hand"] = Json::array();
  for (const FollowedStroke& followed : simulation.strokes) {
    Json& hand = hands.emplace_back(Json::array());
    for (const Pose& goal : followed.stroke.goals) hand.push_back(place(goal.position));
  }
  for (std::size_t run = 0; run < tallies.size(); ++run) {
    record["runs"].push_back(run_json(simulation, run, tallies[run], moments[run]));
  }
  for (const char* part : {"comparison", "benchmark"}) record[part] = nullptr;
  return record;
}

}  // namespace keepout::app
