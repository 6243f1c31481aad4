// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
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

/// Returns the median, the mean of the middle two of an even number of values; null without values.
Json median(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// Returns a member of the runs that have it; most have it only if they are solved.
std::vector<double> values_of(const Group& runs, const char* member) {
  std::vector<double> values;
  for (const Json* run : runs) {
    if (!run->at(member).is_null()) values.push_back(run->at(member).get<double>());
  }
  return values;
}

Figure same(const char* member) {
  return [=](const Group& runs) { return runs.front()->at(member); };
}
Figure median_of(const char* member) {
  return [=](const Group& runs) { return median(values_of(runs, member)); };
}
Figure sum_of(const char* member) {
  return [=](const Group& runs) {
    std::size_t sum = 0;
    for (const Json* run : runs) {
      const Json& value = run->at(member);
      if (value.is_null()) continue;
      sum += value.is_boolean() ? value.get<bool>() : value.get<std::size_t>();
    }
    return Json(sum);
  };
}
Json valid(const Group& runs) {
  return static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const Json* run) { return run->at("solved") && is_valid(*run); }));
}
Json least_clearance(const Group& runs) {
  const std::vector<double> values = values_of(runs, "clearance_mm");
  return values.empty() ? Json(nullptr) : Json(std::ranges::min(values));
}
Json deepest(const Group& runs) {
  double deepest = 0.0;
  for (const double clearance : values_of(runs, "clearance_mm")) {
    deepest = std::max(deepest, -clearance);
  }
  return deepest;
}

std::string shown_count(const Json& value) {
  return value.is_null() ? "-" : grouped(static_cast<std::size_t>(value.get<double>()));
}
template <int digits>
std::string shown_figure(const Json& value) {
  return value.is_null() ? "-" : rounded(value.get<double>(), digits);
}

bool is_of_an_instrument(const Json& run) { return run.contains("motions"); }

Columns<Group> summary_columns(bool is_instrument) {
  Columns<Group> columns{{"mesh", same("mesh"), "mesh", -12},
                         {"checker", same("checker"), "checker", -15},
                         {"runs", &Group::size, "runs", 5, &shown_count},
                         {"solved", sum_of("solved"), "solved", 6, &shown_count},
                         {"valid", valid, "valid", 6, &shown_count}};
  if (is_instrument) {
    columns.insert(columns.end(), {{"motions", sum_of("motions"), "motions", 8, &shown_count},
                                   {"too_close", sum_of("too_close"), "too close", 9, &shown_count},
                                   {"entering", sum_of("entering"), "in mesh", 7, &shown_count},
                                   {"unproven", sum_of("unproven"), "unproven", 8, &shown_count},
                                   {"deepest_mm", deepest, "deepest mm", 10, &shown_figure<3>}});
  } else {
    columns.insert(columns.end(),
                   {{"entering", sum_of("enters"), "enters", 7, &shown_count},
                    {"least_clearance_mm", least_clearance, "clearance mm", 12, &shown_figure<4>}});
  }
  columns.insert(columns.end(),
                 {{"median_seconds", median_of("seconds"), "median s", 9, &shown_figure<3>},
                  {"median_checking_seconds", median_of("checking_seconds"), "checking s", 10,
                   &shown_figure<3>},
                  {"median_checks", median_of("checks"), "checks", 8, &shown_count},
                  {"median_length_mm", median_of("length_mm"), "length mm", 9, &shown_figure<3>}});
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

/// Returns what the head of a record says of the options.
RecordHead head_of(const PlanOptions& options) {
  const bool is_instrument = !options.robot.empty();
  const std::string each = is_instrument ? "each run" : "each problem";
  const std::string kept = is_instrument ? "margin" : "clearance";
  const std::string seconds = trimmed(options.seconds) + " s";
  const std::string length = trimmed(is_instrument ? options.margin : options.clearance()) + " mm";
  Json settings = {{"planner", options.planner},
                   {"time for " + each, seconds},
                   {kept, length},
                   {"problems of each mesh", std::to_string(options.problems)}};
  if (is_instrument) {
    settings["robot"] = options.robot;
    settings["runs of each problem"] = std::to_string(options.seeds);
  } else {
    settings["motion sphere radius"] = trimmed(options.radius) + " mm";
  }
  settings["seed"] = std::to_string(options.seed);
  return {.kind = is_instrument ? "plan_robot" : "plan",
          .command = options.command,
          .subject =
              "Plans for " + (is_instrument ? "a whole instrument, " + options.robot : "a tip") +
              ", judged by an independent oracle: " + options.planner + ", " + seconds + " for " +
              each + ", " + kept + " " + length + (options.simplify ? ", simplified" : ""),
          .machine = this_machine(),
          .settings = std::move(settings)};
}

}  // namespace

bool is_valid(const Json& run) {
  return is_of_an_instrument(run) ? run["too_close"] == 0 : run["valid"] == true;
}

bool is_keepouts(const Json& run) {
  return run["checker"] == Checker{Checker::Kind::certified}.name() ||
         run["checker"] == Checker{Checker::Kind::sliding}.name();
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
    for (const double resolution : options.resolutions) all.push_back({kind, resolution});
  }
  all.push_back({Kind::certified});
  if (is_tip) all.push_back({Kind::sliding});
  return all;
}

Json record_of(const PlanOptions& options, std::span<const std::unique_ptr<Planning>> plannings,
               Json runs, bool complete) {
  const bool is_instrument = !options.robot.empty();
  RecordHead head = head_of(options);
  head.complete = complete;
  head.headline = headline_of(runs, is_instrument);
  Json record = new_record(head);
  if (is_instrument) {
    record["robot"] = options.robot;
  } else {
    record["seed"] = options.seed;
  }
  record["planner"] = options.planner;
  record["seconds_allowed"] = options.seconds;
  if (is_instrument) {
    record["margin_mm"] = options.margin;
  } else {
    record["clearance_mm"] = options.clearance();
    record["radius_mm"] = options.radius;
  }
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
