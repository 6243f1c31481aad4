// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "plan/checker.h"
#include "plan/path_verdict.h"
#include "plan/plan.h"
#include "plan/problems.h"
#include "plan/run_planner.h"

namespace keepout::app {

/// One problem under one checker.
struct PlanningRun {
  std::string mesh;
  std::string planner;  // that was run
  Checker checker;
  Problem problem;
  PlannedPath path;
  PathVerdict verdict;  // of a solved one
};

/// All runs of a mesh under one checker.
struct PlanningSummary {
  std::string mesh;
  Checker checker;
  std::size_t runs = 0;
  std::size_t solved = 0;
  std::size_t valid = 0;         // of the solved, by the oracle
  std::size_t entering = 0;      // of the solved: the path touches the mesh
  double least_clearance = 0.0;  // of all solved [mm]
  double median_seconds = 0.0;   // of all; one that ran out of time took all of it
  double median_checking = 0.0;  // [s]
  double median_length = 0.0;    // of the solved [mm]
  double checks = 0.0;           // median
};

/// In the order of the runs.
std::vector<PlanningSummary> summaries(const std::vector<PlanningRun>& runs);

void print_table(std::ostream& out, const std::vector<PlanningSummary>& rows);
void write_planning_json(std::ostream& out, const PlanOptions& options,
                         const std::vector<PlanningRun>& runs);
void write_planning_csv(std::ostream& out, const std::vector<PlanningRun>& runs);

}  // namespace keepout::app
