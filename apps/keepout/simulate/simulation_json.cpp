// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulation_json.h"

#include <algorithm>
#include <cmath>

#include "keepout/error.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "record/record.h"
#include "simulate/moments.h"
#include "simulate/verdict.h"

namespace keepout::app {
namespace {

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

/// With so many digits behind the point as are told of a cycle.
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

Json record_of(const RunSummary& summary, SurfaceKind surface) {
  const auto if_timed = [&](double value) { return summary.max_us > 0.0 ? Json(value) : Json(); };
  const auto if_closed = [&](auto value) {
    return surface == SurfaceKind::closed ? Json(value) : Json();
  };
  return {
      {"strokes", summary.strokes},
      {"cycles", summary.cycles},
      {"moved_freely", summary.moved_freely},
      {"limited", summary.limited},
      {"stopped", summary.stopped},
      {"p50_us", if_timed(summary.p50_us)},
      {"p99_us", if_timed(summary.p99_us)},
      {"p999_us", if_timed(summary.p999_us)},
      {"max_us", if_timed(summary.max_us)},
      {"rate_khz", if_timed(summary.rate_khz)},
      {"closest_approach_mm", touches(summary.closest_approach) ? 0.0 : summary.closest_approach},
      {"deepest_mm", if_closed(summary.deepest_penetration)},
      {"cycles_inside", if_closed(summary.cycles_inside)},
      {"strokes_inside", if_closed(summary.strokes_inside)},
      {"crossings", summary.crossings},
      {"strokes_breached", summary.strokes_breached}};
}

Json run_json(const Simulation& simulation, std::size_t number, const RunSummary& summary) {
  const Run& run = simulation.runs[number];
  const Moment worst = worst_moment(simulation, number);
  Json strokes = Json::array(), crossings = Json::array();
  for (const Stroke& stroke : run.strokes) strokes.push_back(record_of(stroke));
  for (const auto& [stroke, cycle] : run.crossings) {
    crossings.push_back({{"stroke", stroke}, {"cycle", cycle}});
  }
  return {{"rule", run.rule},
          {"name", display_name(run)},
          {"description", explanation(run)},
          {"kept_out", summary.kept_out()},
          {"words", outcome_of(summary, simulation.surface)},
          {"summary", record_of(summary, simulation.surface)},
          {"worst", {{"stroke", worst.stroke}, {"cycle", worst.cycle}}},
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

/// Where the tips of all runs were in a stroke, and half as far again on all sides.
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

Json record_of(const Simulation& simulation) {
  check(simulation);
  std::vector<RunSummary> summaries;
  for (const Run& run : simulation.runs) summaries.push_back(summarize(run));
  RecordHead head{.kind = "simulate",
                  .command = simulation.command,
                  .subject = subject(simulation, summaries),
                  .headline = headline(simulation, summaries),
                  .account = {account(simulation, summaries)},
                  .machine = this_machine()};
  if (std::string times = step_times(simulation, summaries); !times.empty()) {
    head.account.push_back(std::move(times));
  }
  for (const auto& [name, value] : simulation.settings) head.settings[name] = value;

  Json record = new_record(head);
  const Moment moment = telling_moment(simulation);
  Json& mesh = record["mesh"] =
      drawn_mesh(simulation.mesh_name, *simulation.mesh, around(simulation, moment.stroke));
  mesh["surface"] = simulation.surface == SurfaceKind::closed ? "closed" : "open";
  record["kept_mm"] = simulation.margin;
  record["cycle_s"] = simulation.cycle_seconds;
  record["up"] = json_of(simulation.up);
  record["moment"] = {{"run", moment.run}, {"stroke", moment.stroke}, {"cycle", moment.cycle}};
  record["hand"] = hands_of(simulation.runs.front());
  Json& runs = record["runs"] = Json::array();
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    runs.push_back(run_json(simulation, r, summaries[r]));
  }
  record["benchmark"] = record["comparison"] = nullptr;
  return record;
}

}  // namespace keepout::app
