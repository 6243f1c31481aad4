// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/planning_result.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "keepout/simd_target.h"
#include "keepout/version.h"
#include "machine.h"
#include "number_text.h"

namespace keepout::app {
namespace {

using Json = nlohmann::ordered_json;

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

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

std::string number_or_dash(std::size_t of, double value, int digits = 3) {
  return of == 0 ? "-" : rounded(value, digits);
}

/// A name as a field of CSV: in quotes where it must be.
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

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
  for (const PlanningSummary& row : rows) {
    line(row.mesh, row.checker.name(),
         {std::to_string(row.solved) + "/" + std::to_string(row.runs),
          row.solved == 0 ? "-" : std::to_string(row.valid) + "/" + std::to_string(row.solved),
          row.solved == 0 ? "-" : std::to_string(row.entering),
          number_or_dash(row.solved, row.least_clearance, 4), rounded(row.median_seconds),
          rounded(row.median_checking), grouped(static_cast<std::size_t>(row.checks)),
          number_or_dash(row.solved, row.median_length)});
  }
}

void write_planning_json(std::ostream& out, const PlanOptions& options,
                         const std::vector<PlanningRun>& runs) {
  Json root{{"version", KEEPOUT_VERSION},
            {"machine", processor()},
            {"simd", simd_target()},
            {"compiler", KEEPOUT_COMPILER},
            {"build", KEEPOUT_BUILD_TYPE},
            {"seed", options.seed},
            {"planner", options.planner},
            {"seconds_allowed", options.seconds},
            {"clearance_mm", options.tool_radius + options.margin},
            {"radius_mm", options.radius},
            {"range_mm", options.range},
            {"simplified", options.simplify}};
  Json list = Json::array();
  for (const PlanningRun& run : runs) {
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
    if (run.path.solved) {
      entry["valid"] = run.verdict.is_valid();
      entry["enters"] = run.verdict.enters;
      entry["bad_pieces"] = run.verdict.bad_pieces;
      entry["clearance_mm"] = run.verdict.clearance;
      entry["length_mm"] = run.verdict.length;
      Json points = Json::array();
      for (const Vec3& point : run.path.points) points.push_back(json_of(point));
      entry["path"] = std::move(points);
    }
    list.push_back(std::move(entry));
  }
  root["runs"] = std::move(list);
  out << root.dump(1) << '\n';
}

void write_planning_csv(std::ostream& out, const std::vector<PlanningRun>& runs) {
  out << "mesh,problem,checker,planner,solved,seconds,checking_seconds,checks,valid,enters,"
         "bad_pieces,pieces,clearance_mm,length_mm,straight_mm,detour\n"
      << std::setprecision(9);
  for (const PlanningRun& run : runs) {
    out << field(run.mesh) << ',' << run.problem.number << ',' << run.checker.name() << ','
        << run.planner << ',' << run.path.solved << ',' << run.path.seconds << ','
        << run.path.checking_seconds << ',' << run.path.checks << ',';
    if (run.path.solved) {
      out << run.verdict.is_valid() << ',' << run.verdict.enters << ',' << run.verdict.bad_pieces
          << ',' << run.path.points.size() - 1 << ',' << run.verdict.clearance << ','
          << run.verdict.length;
    } else {
      out << ",,,,,";
    }
    out << ',' << run.problem.straight << ',' << run.problem.detour << '\n';
  }
}

}  // namespace keepout::app
