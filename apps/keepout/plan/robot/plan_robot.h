// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "plan/planning_run.h"
#include "plan/robot/judge_path.h"
#include "plan/robot/problems.h"
#include "shared/columns.h"

namespace keepout::app {

/// One planner on one problem of a whole instrument, under one checker, from one seed.
struct RobotPlanningRun {
  std::string mesh;
  Checker checker;
  RobotProblem problem;
  std::uint64_t seed = 0;  // of the planner
  bool solved = false;
  double seconds = 0.0;                   // of the planner, and of the simplifier
  double checking_seconds = 0.0;          // of it, in the checker
  std::uint64_t checks = 0;               // motions asked about
  std::vector<std::vector<double>> path;  // of the joints; empty unless solved
  double length = 0.0;                    // as make_joint_space measures it [mm]
  JointPathVerdict verdict = {};          // of a solved one

  /// Solved, and no motion of it comes too close.
  bool is_valid() const noexcept { return solved && verdict.too_close == 0; }
};

/// Plans for the robot that options.robot names: see plan().
int plan_with_robot(const PlanOptions& options, std::ostream& out);

/// A row for each mesh and checker, in the order of the runs.
Json robot_summaries(const std::vector<RobotPlanningRun>& runs);
void print_robot_summaries(std::ostream& out, const Json& rows);

/// The record of it: see docs/records.md. `complete`: it was not stopped.
Json robot_record_of(const PlanOptions& options, const std::vector<RobotPlanningRun>& runs,
                     bool complete);

}  // namespace keepout::app
