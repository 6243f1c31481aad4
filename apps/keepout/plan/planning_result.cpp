// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <ostream>
#include <utility>

#include "plan/planning_run.h"
#include "record/drawn_mesh.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"
#include "verify/judge.h"

namespace keepout::app {
namespace {

template <class Value>
double median_of(const std::vector<const PlanningRun*>& runs, const Value& value) {
  std::vector<double> values;
  for (const PlanningRun* run : runs) values.push_back(static_cast<double>(value(*run)));
  return median(std::move(values));
}

PlanningSummary summary(const std::vector<const PlanningRun*>& runs) {
  PlanningSummary row;
  row.mesh = runs.front()->mesh;
  row.checker = runs.front()->checker;
  row.runs = runs.size();
  row.least_clearance = std::numeric_limits<double>::infinity();
  std::vector<const PlanningRun*> solved;
  for (const PlanningRun* run : runs) {
    if (!run->path.solved) continue;
    solved.push_back(run);
    row.valid += run->verdict.is_valid();
    row.entering += run->verdict.enters;
    row.least_clearance = std::min(row.least_clearance, run->verdict.clearance);
  }
  row.solved = solved.size();
  row.median_seconds = median_of(runs, [](const PlanningRun& r) { return r.path.seconds; });
  row.median_checking =
      median_of(runs, [](const PlanningRun& r) { return r.path.checking_seconds; });
  row.checks = median_of(runs, [](const PlanningRun& r) { return r.path.checks; });
  row.median_length = median_of(solved, [](const PlanningRun& r) { return r.verdict.length; });
  return row;
}

Json entry_of(const PlanningRun& run) {
  Json entry{{"mesh", run.mesh},
             {"problem", run.problem.number},
             {"start", json_of(run.problem.start)},
             {"goal", json_of(run.problem.goal)},
             {"straight_mm", run.problem.straight},
             {"detour", run.problem.detour},
             {"checker", run.checker.name()},
             {"planner", run.planner},
             {"solved", run.path.solved},
             {"seconds", run.path.seconds},
             {"checking_seconds", run.path.checking_seconds},
             {"checks", run.path.checks}};
  for (const char* key : {"valid", "enters", "bad_pieces", "pieces", "clearance_mm", "length_mm"}) {
    entry[key] = nullptr;
  }
  if (!run.path.solved) return entry;
  entry["valid"] = run.verdict.is_valid();
  entry["enters"] = run.verdict.enters;
  entry["bad_pieces"] = run.verdict.bad_pieces;
  entry["pieces"] = run.path.points.size() - 1;
  entry["clearance_mm"] = run.verdict.clearance;
  entry["length_mm"] = run.verdict.length;
  Json& path = entry["path"] = Json::array();
  for (const Vec3& point : run.path.points) path.push_back(json_of(point));
  Json& too_near = entry["too_near"] = Json::array();
  for (const std::vector<Vec3>& length : run.too_near) {
    Json& points = too_near.emplace_back(Json::array());
    for (const Vec3& point : length) points.push_back(json_of(point));
  }
  return entry;
}

/// A row of a table: solved, valid, enters, clearance, seconds, checking, checks and length.
std::vector<std::string> cells_of(const PlanningSummary& row) {
  const bool none = row.solved == 0;
  const std::string solved = std::to_string(row.solved);
  return {solved + "/" + std::to_string(row.runs),
          none ? "-" : std::to_string(row.valid) + "/" + solved,
          none ? "-" : std::to_string(row.entering),
          none ? "-" : rounded(row.least_clearance, 4),
          rounded(row.median_seconds),
          rounded(row.median_checking),
          grouped(static_cast<std::size_t>(row.checks)),
          none ? "-" : rounded(row.median_length)};
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

std::string lead(const PlanOptions& options) {
  return options.planner + ", " + trimmed(options.seconds) + " s for each problem, clearance " +
         trimmed(options.clearance()) + " mm, seed " + std::to_string(options.seed);
}

std::vector<PlanningSummary> summaries(const std::vector<PlanningRun>& runs) {
  std::vector<std::vector<const PlanningRun*>> groups;
  for (const PlanningRun& run : runs) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
      return g.front()->mesh == run.mesh && g.front()->checker.name() == run.checker.name();
    });
    if (group == groups.end()) {
      groups.push_back({&run});
    } else {
      group->push_back(&run);
    }
  }
  std::vector<PlanningSummary> rows;
  for (const auto& group : groups) rows.push_back(summary(group));
  return rows;
}

double least_distance(const Scene& scene, const PlanOptions& options) {
  // The tip may be 10 mm beyond the mesh along each axis.
  const Vec3 farthest(scene.farthest() + 30.0, 0.0, 0.0);
  const double margin = options.clearance();
  return margin - 3.0 * tolerance(scene, {.radius = options.radius, .margin = margin}, farthest);
}

PathVerdict judge_path(const Scene& scene, std::span<const Vec3> points, double least) {
  PathVerdict verdict;
  oracle::SafetyOracle oracle = scene.oracle();
  // No piece is farther off than its ends, so the search for the nearest need not reach farther.
  verdict.clearance = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    verdict.clearance = std::min(verdict.clearance, oracle.distance(point));
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    const oracle::Finding finding =
        oracle.check(points[i - 1], points[i], least, verdict.clearance);
    verdict.clearance = std::min(verdict.clearance, finding.distance);
    verdict.enters |= finding.crosses;
    verdict.is_too_near |= finding.below;
    verdict.bad_pieces += finding.crosses || finding.below;
    verdict.length += (points[i] - points[i - 1]).norm();
  }
  return verdict;
}

void print_table(std::ostream& out, const std::vector<PlanningSummary>& rows) {
  std::size_t mesh = 4;
  for (const PlanningSummary& row : rows) mesh = std::max(mesh, row.mesh.size());
  const auto line = [&](const std::string& name, const std::string& checker,
                        const std::vector<std::string>& cells) {
    out << "  " << std::left << std::setw(static_cast<int>(mesh) + 2) << name << std::setw(17)
        << checker << std::right;
    constexpr std::array widths{9, 9, 8, 14, 11, 12, 11, 11};
    for (std::size_t i = 0; i < cells.size(); ++i) out << std::setw(widths[i]) << cells[i];
    out << '\n';
  };
  line("mesh", "checker",
       {"solved", "valid", "enters", "clearance mm", "median s", "checking s", "checks",
        "length mm"});
  for (const PlanningSummary& row : rows) line(row.mesh, row.checker.name(), cells_of(row));
}

std::string headline(const std::vector<PlanningRun>& runs) {
  struct Count {
    std::size_t all = 0, bad = 0;
  } ours, sampled;
  for (const PlanningRun& run : runs) {
    if (!run.path.solved) continue;
    Count& count = run.checker.is_keepouts() ? ours : sampled;
    ++count.all;
    count.bad += !run.verdict.is_valid();
  }
  return grouped(sampled.bad) + " of " + counted(sampled.all, "path") +
         " under sampled checking, and " + grouped(ours.bad) + " of " + grouped(ours.all) +
         " under keepout's, come nearer to the anatomy than allowed, or enter it.";
}

std::vector<std::vector<Vec3>> lengths_too_near(const Scene& scene, std::span<const Vec3> points,
                                                double least) {
  constexpr double longest = 0.5;  // of what is judged at once [mm]
  oracle::SafetyOracle oracle = scene.oracle();
  std::vector<std::vector<Vec3>> lengths;
  bool was_bad = false;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 along = points[i] - points[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / longest)));
    for (int k = 0; k < pieces; ++k) {
      const Vec3 from = points[i - 1] + along * (static_cast<double>(k) / pieces);
      const Vec3 to = points[i - 1] + along * (static_cast<double>(k + 1) / pieces);
      const bool is_bad = oracle.check(from, to, least).below;
      if (is_bad && !was_bad) lengths.push_back({from});
      if (is_bad) lengths.back().push_back(to);
      was_bad = is_bad;
    }
  }
  return lengths;
}

Json record_of(const PlanOptions& options, const std::vector<PlanningScene>& scenes,
               const std::vector<PlanningRun>& runs, bool complete) {
  Json record =
      new_record({.kind = "plan",
                  .command = options.command,
                  .complete = complete,
                  .subject = "Plans through anatomy, judged by an exact oracle: " + lead(options) +
                             (options.simplify ? ", simplified" : ""),
                  .headline = headline(runs),
                  .account = {"The sliding checker has a planner of its own, "
                              "SlidingConnect. Valid is a path whose whole way keeps the "
                              "clearance."},
                  .machine = this_machine(),
                  .settings = {{"planner", options.planner},
                               {"time for each problem", trimmed(options.seconds) + " s"},
                               {"clearance", trimmed(options.clearance()) + " mm"},
                               {"motion sphere radius", trimmed(options.radius) + " mm"},
                               {"problems of each mesh", std::to_string(options.problems)},
                               {"seed", std::to_string(options.seed)}}});
  record["seed"] = options.seed;
  record["planner"] = options.planner;
  record["seconds_allowed"] = options.seconds;
  record["clearance_mm"] = options.clearance();
  record["radius_mm"] = options.radius;
  record["range_mm"] = options.range;
  record["simplified"] = options.simplify;
  for (const char* list : {"meshes", "checkers", "summaries", "runs"}) record[list] = Json::array();
  for (const PlanningScene& where : scenes) {
    Json mesh = drawn_mesh(where.scene.name(), *where.scene.mesh());
    mesh["inside"] = where.space == PlanningScene::Space::within;
    record["meshes"].push_back(std::move(mesh));
  }
  for (const Checker& checker : checkers(options.resolutions)) {
    record["checkers"].push_back(checker.name());
  }
  for (const PlanningSummary& row : summaries(runs)) {
    const auto if_solved = [&](double value) { return row.solved > 0 ? Json(value) : Json(); };
    record["summaries"].push_back({{"mesh", row.mesh},
                                   {"checker", row.checker.name()},
                                   {"runs", row.runs},
                                   {"solved", row.solved},
                                   {"valid", row.valid},
                                   {"entering", row.entering},
                                   {"least_clearance_mm", if_solved(row.least_clearance)},
                                   {"median_seconds", row.median_seconds},
                                   {"median_checking_seconds", row.median_checking},
                                   {"median_checks", row.checks},
                                   {"median_length_mm", if_solved(row.median_length)}});
  }
  for (const PlanningRun& run : runs) record["runs"].push_back(entry_of(run));
  return record;
}

}  // namespace keepout::app
