// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "plan/robot/plan_robot.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

using Run = RobotPlanningRun;
/// The runs of one mesh under one checker.
using Group = std::vector<const Run*>;

template <class Value>
std::size_t sum_of(const Group& runs, const Value& value) {
  std::size_t sum = 0;
  for (const Run* run : runs) sum += static_cast<std::size_t>(value(*run));
  return sum;
}

/// Of those solved, or of all.
template <class Value>
Json median_of(const Group& runs, bool of_solved, const Value& value) {
  std::vector<double> values;
  for (const Run* run : runs) {
    if (run->solved || !of_solved) values.push_back(static_cast<double>(value(*run)));
  }
  return values.empty() ? Json(nullptr) : Json(median(std::move(values)));
}

double deepest_of(const Group& runs) {
  double deepest = 0.0;
  for (const Run* run : runs) deepest = std::max(deepest, -run->verdict.clearance);
  return deepest;
}

std::string shown_whole(const Json& value) {
  return value.is_null() ? "-" : grouped(static_cast<std::size_t>(value.get<double>()));
}

const Columns<Group>& summary_columns() {
  static const Columns<Group> all{
      {"mesh", [](const Group& g) { return Json(g.front()->mesh); }, "mesh", -12},
      {"checker", [](const Group& g) { return Json(g.front()->checker.name()); }, "checker", -15},
      {"runs", [](const Group& g) { return Json(g.size()); }, "runs", 5, &count_text},
      {"solved", [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.solved; })); },
       "solved", 6, &count_text},
      {"valid",
       [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.is_valid(); })); },
       "valid", 6, &count_text},
      {"motions",
       [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.verdict.motions; })); },
       "motions", 8, &count_text},
      {"too_close",
       [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.verdict.too_close; })); },
       "too close", 9, &count_text},
      {"entering",
       [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.verdict.entering; })); },
       "in mesh", 7, &count_text},
      {"unproven",
       [](const Group& g) { return Json(sum_of(g, [](auto& r) { return r.verdict.unproven; })); },
       "unproven", 8, &count_text},
      {"deepest_mm", [](const Group& g) { return Json(deepest_of(g)); }, "deepest mm", 10,
       &figure_text<>},
      {"median_seconds",
       [](const Group& g) { return median_of(g, false, [](auto& r) { return r.seconds; }); },
       "median s", 9, &figure_text<>},
      {"median_checking_seconds",
       [](const Group& g) {
         return median_of(g, false, [](auto& r) { return r.checking_seconds; });
       },
       "checking s", 10, &figure_text<>},
      {"median_checks",
       [](const Group& g) { return median_of(g, false, [](auto& r) { return r.checks; }); },
       "asked", 8, &shown_whole},
      {"median_length_mm",
       [](const Group& g) { return median_of(g, true, [](auto& r) { return r.length; }); },
       "length mm", 9, &figure_text<>}};
  return all;
}

Json entry_of(const Run& run) {
  Json entry{{"mesh", run.mesh},
             {"problem", run.problem.number},
             {"seed", run.seed},
             {"checker", run.checker.name()},
             {"base_position", json_of(run.problem.base.position)},
             {"base_rotation", Json::array()},
             {"start", run.problem.start},
             {"goal", run.problem.goal},
             {"advance_mm", run.problem.advance},
             {"solved", run.solved},
             {"seconds", run.seconds},
             {"checking_seconds", run.checking_seconds},
             {"checks", run.checks}};
  for (int row = 0; row < 3; ++row) {
    entry["base_rotation"].push_back(json_of(Vec3(run.problem.base.rotation.row(row))));
  }
  for (const char* key :
       {"motions", "too_close", "entering", "unproven", "clearance_mm", "length_mm"}) {
    entry[key] = nullptr;
  }
  if (!run.solved) return entry;
  entry["motions"] = run.verdict.motions;
  entry["too_close"] = run.verdict.too_close;
  entry["entering"] = run.verdict.entering;
  entry["unproven"] = run.verdict.unproven;
  entry["clearance_mm"] = or_null(run.verdict.clearance);
  entry["length_mm"] = run.length;
  entry["path"] = run.path;
  return entry;
}

std::string headline_of(const std::vector<Run>& runs) {
  struct Count {
    std::size_t all = 0, bad = 0;
  } certified, sampled;
  for (const Run& run : runs) {
    Count& count = run.checker.is_keepouts() ? certified : sampled;
    count.all += run.solved ? 1 : 0;
    count.bad += run.solved && !run.is_valid() ? 1 : 0;
  }
  return grouped(sampled.bad) + " of " + counted(sampled.all, "path") +
         " under sampled checking, and " + grouped(certified.bad) + " of " +
         grouped(certified.all) +
         " under keepout's, bring the instrument closer to the anatomy than allowed.";
}

}  // namespace

Json robot_summaries(const std::vector<Run>& runs) {
  std::vector<Group> groups;
  for (const Run& run : runs) {
    const auto group = std::ranges::find_if(groups, [&](const Group& g) {
      return g.front()->mesh == run.mesh && g.front()->checker.name() == run.checker.name();
    });
    (group == groups.end() ? groups.emplace_back() : *group).push_back(&run);
  }
  return json_of(summary_columns(), groups);
}

void print_robot_summaries(std::ostream& out, const Json& rows) {
  print_headings(out, summary_columns());
  out << '\n';
  for (const Json& row : rows) {
    print_cells(out, summary_columns(),
                [&](const auto& column) { return column.text(row.at(column.key)); });
    out << '\n';
  }
}

Json robot_record_of(const PlanOptions& options, const std::vector<Run>& runs, bool complete) {
  Json record = new_record(
      {.kind = "plan_robot",
       .command = options.command,
       .complete = complete,
       .subject = "Plans for a whole instrument, " + options.robot + ", judged by an independent " +
                  "oracle: " + options.planner + ", " + trimmed(options.seconds) +
                  " s for each run, margin " + trimmed(options.margin) + " mm",
       .headline = headline_of(runs),
       .account =
           {"Too close, in the mesh, unproven: motions between neighbours on the paths that "
            "were found. The oracle looks at them every 0.05 mm; unproven are those that "
            "keepout does not prove in pieces of 1 mm. Valid: paths without a motion that is "
            "too close."},
       .machine = this_machine(),
       .settings = {{"robot", options.robot},
                    {"planner", options.planner},
                    {"time for each run", trimmed(options.seconds) + " s"},
                    {"margin", trimmed(options.margin) + " mm"},
                    {"problems of each mesh", std::to_string(options.problems)},
                    {"runs of each problem", std::to_string(options.seeds)},
                    {"seed", std::to_string(options.seed)}}});
  record["robot"] = options.robot;
  record["planner"] = options.planner;
  record["seconds_allowed"] = options.seconds;
  record["margin_mm"] = options.margin;
  record["range_mm"] = options.range;
  record["simplified"] = options.simplify;
  record["summaries"] = robot_summaries(runs);
  Json& entries = record["runs"] = Json::array();
  for (const Run& run : runs) entries.push_back(entry_of(run));
  return record;
}

}  // namespace keepout::app
