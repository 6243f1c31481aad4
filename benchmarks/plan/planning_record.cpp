// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <ostream>
#include <utility>

#include "plan/planning.h"
#include "record/drawn_mesh.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// The runs of one mesh under one checker.
using Group = std::vector<const Json*>;
/// Returns the figure of a group for a column.
using Figure = std::function<Json(const Group&)>;

Figure same(const char* member) {
  return [=](const Group& runs) { return runs.front()->at(member); };
}

/// Reduces a member of the runs that have it; most have it only if they are solved.
Figure figure(const char* member, Json (*reduce)(std::vector<double>)) {
  return [=](const Group& runs) {
    std::vector<double> values;
    for (const Json* run : runs) {
      const Json& value = run->at(member);
      if (value.is_null()) continue;
      values.push_back(value.is_boolean() ? (value ? 1.0 : 0.0) : value.get<double>());
    }
    return reduce(std::move(values));
  };
}

Json sum(std::vector<double> values) {
  return static_cast<std::size_t>(std::accumulate(values.begin(), values.end(), 0.0));
}
/// Returns the mean of the middle two of an even number of values; null without values.
Json median(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}
Json least(std::vector<double> values) {
  return values.empty() ? Json() : Json(std::ranges::min(values));
}
/// Returns the greatest depth from clearances.
Json deepest(std::vector<double> values) {
  return values.empty() ? 0.0 : std::max(0.0, -std::ranges::min(values));
}
Json valid(const Group& runs) {
  return static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const Json* run) { return run->at("solved") && is_valid(*run); }));
}

/// Returns a duration in a suitable unit; "-" for null.
std::string duration_text(const Json& seconds) {
  return seconds.is_null() ? "-" : in_ascii(time_text(1e6 * seconds.get<double>()));
}

/// Returns the median of counts, which is whole or a half; "-" for null.
std::string median_count_text(const Json& median) {
  const bool is_whole =
      median.is_null() || median.get<double>() == std::floor(median.get<double>());
  return count_text(median) + (is_whole ? "" : ".5");
}

bool is_of_an_instrument(const Json& run) { return run.contains("motions"); }

Columns<Group> summary_columns(bool is_instrument) {
  Columns<Group> columns{{"mesh", same("mesh"), "mesh", -12},
                         {"checker", same("checker"), "checker", -15},
                         {"runs", &Group::size, "runs", 5, count_text},
                         {"solved", figure("solved", sum), "solved", 6, count_text},
                         {"valid", valid, "valid", 6, count_text}};
  const auto add = [&](std::initializer_list<Column<Group>> more) {
    columns.insert(columns.end(), more);
  };
  if (is_instrument) {
    add({{"motions", figure("motions", sum), "motions", 8, count_text},
         {"too_close", figure("too_close", sum), "too close", 9, count_text},
         {"entering", figure("entering", sum), "in mesh", 7, count_text},
         {"unproven", figure("unproven", sum), "unproven", 8, count_text},
         {"deepest_mm", figure("clearance_mm", deepest), "deepest mm", 10, figure_text<3>}});
  } else {
    add({{"entering", figure("enters", sum), "enters", 7, count_text},
         {"least_clearance_mm", figure("clearance_mm", least), "clearance mm", 12,
          figure_text<4>}});
  }
  add({{"median_seconds", figure("seconds", median), "median", 9, duration_text},
       {"median_checking_seconds", figure("checking_seconds", median), "checking", 10,
        duration_text},
       {"median_checks", figure("checks", median), "checks", 10, median_count_text},
       {"median_length_mm", figure("length_mm", median), "length mm", 9, figure_text<3>}});
  return columns;
}

std::vector<Group> groups_of(const Json& runs) {
  std::vector<Group> groups;
  for (const Json& run : runs) {
    const auto group = std::ranges::find_if(groups, [&](const Group& g) {
      return g.front()->at("mesh") == run["mesh"] && g.front()->at("checker") == run["checker"];
    });
    (group == groups.end() ? groups.emplace_back() : *group).push_back(&run);
  }
  return groups;
}

std::string headline_of(const Json& runs, bool is_instrument) {
  struct Count {
    std::size_t all = 0, bad = 0;
  } ours, sampled;
  for (const Json& run : runs) {
    if (!run["solved"]) continue;
    Count& count = is_keepouts(run) ? ours : sampled;
    ++count.all;
    count.bad += is_valid(run) ? 0 : 1;
  }
  return grouped(sampled.bad) + " of " + counted(sampled.all, "path") +
         " under sampled checking, and " + grouped(ours.bad) + " of " + grouped(ours.all) +
         " under keepout's, " +
         (is_instrument ? "bring the instrument closer to the anatomy than allowed."
                        : "come nearer to the anatomy than allowed, or enter it.");
}

}  // namespace

bool is_valid(const Json& run) {
  return is_of_an_instrument(run) ? run["too_close"] == 0 : run["valid"] == true;
}

bool is_keepouts(const Json& run) {
  return run["checker"] == "certified" || run["checker"] == "sliding";
}

std::string Checker::name() const {
  constexpr std::array names{"sampled", "widened", "certified", "sliding"};
  const std::string kind_name = names[static_cast<std::size_t>(kind)];
  return is_keepouts() ? kind_name : kind_name + " " + trimmed(100.0 * resolution) + " %";
}

std::vector<Checker> checkers_of(const PlanOptions& options) {
  using Kind = Checker::Kind;
  const bool is_tip = options.robot.empty();
  std::vector<Checker> all;
  for (const Kind kind : {Kind::sampled, Kind::widened}) {
    if (kind == Kind::widened && !is_tip) continue;
    for (const double resolution : options.resolutions) {
      const Checker checker{kind, resolution};
      // Runs are counted by the name of their checker.
      if (std::ranges::find(all, checker.name(), &Checker::name) != all.end()) continue;
      all.push_back(checker);
    }
  }
  all.push_back({Kind::certified});
  if (is_tip) all.push_back({Kind::sliding});
  return all;
}

Json record_of(const PlanOptions& options, std::span<const std::unique_ptr<Planning>> plannings,
               Json runs, bool complete) {
  const bool is_instrument = !options.robot.empty();
  const std::string each = is_instrument ? "each run" : "each problem";
  const std::string kept = is_instrument ? "margin" : "clearance";
  const std::string seconds = trimmed(options.seconds) + " s";
  const std::string length = trimmed(is_instrument ? options.margin : options.clearance()) + " mm";
  Json settings = {{"planner", options.planner},
                   {"time for " + each, seconds},
                   {kept, length},
                   {"problems of each mesh", std::to_string(options.problems)}};
  settings.update(is_instrument ? Json{{"robot", options.robot},
                                       {"runs of each problem", std::to_string(options.seeds)}}
                                : Json{{"motion sphere radius", trimmed(options.radius) + " mm"}});
  if (!options.bodies.empty()) settings["bodies"] = options.bodies.string();
  settings["seed"] = std::to_string(options.seed);
  Json record = new_record(
      {.kind = is_instrument ? "plan_robot" : "plan",
       .command = options.command,
       .complete = complete,
       .subject =
           "Plans for " + (is_instrument ? "a whole instrument, " + options.robot : "a tip") +
           ", judged by an independent oracle: " + options.planner + ", " + seconds + " for " +
           each + ", " + kept + " " + length + (options.simplify ? ", simplified" : ""),
       .headline = headline_of(runs, is_instrument),
       .machine = this_machine(),
       .settings = std::move(settings)});
  record.update(is_instrument ? Json{{"robot", options.robot}} : Json{{"seed", options.seed}});
  record["planner"] = options.planner;
  record["seconds_allowed"] = options.seconds;
  record.update(is_instrument
                    ? Json{{"margin_mm", options.margin}}
                    : Json{{"clearance_mm", options.clearance()}, {"radius_mm", options.radius}});
  record["range_mm"] = options.range;
  record["simplified"] = options.simplify;
  if (!is_instrument) {
    for (const char* list : {"meshes", "checkers"}) record[list] = Json::array();
    for (const auto& planning : plannings) {
      const Scene& scene = planning->scene();
      record["meshes"].push_back(drawn_mesh(scene.name(), *scene.mesh()));
      record["meshes"].back()["inside"] = planning->is_within();
    }
    for (const Checker& checker : checkers_of(options)) {
      record["checkers"].push_back(checker.name());
    }
  }
  record["summaries"] = json_of(summary_columns(is_instrument), groups_of(runs));
  record["runs"] = std::move(runs);
  return record;
}

void print_summaries(std::ostream& out, const Json& runs) {
  const bool is_instrument = !runs.empty() && is_of_an_instrument(runs.front());
  print_rows(out, summary_columns(is_instrument), groups_of(runs));
}

}  // namespace keepout::app
