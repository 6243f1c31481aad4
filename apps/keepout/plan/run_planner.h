// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "keepout/ompl/guard_pool.h"
#include "plan/checker.h"
#include "plan/problems.h"

namespace keepout::app {

/// One planner on one problem under one checker.
struct PlanningTask {
  const PlanningScene* where = nullptr;
  const Problem* problem = nullptr;
  Checker checker;
  std::string planner;  // of ompl_planners; the sliding checker brings its own
  std::uint64_t seed = 1;
  double seconds = 5.0;
  double range = 0.0;  // [mm]; 0: OMPL's own
  bool simplify = false;
  double clearance = 0.0;             // for the sampled kinds [mm]
  std::shared_ptr<GuardPool> guards;  // of the others; the same clearance
};

struct PlannedPath {
  bool solved = false;
  double seconds = 0.0;           // of the planner, and of the simplifier where it was asked for
  double checking_seconds = 0.0;  // of it, in the checker; sliding: in the steer
  std::uint64_t checks = 0;       // motions asked about; sliding: ways
  std::vector<Vec3> points;       // empty unless solved [mm]
};

/// The same task yields the same path, unless time ran out. `interrupted`: asked by the planner as
/// it goes on; ends it when true. Not for two threads at once: OMPL's seed is the process's.
PlannedPath run_planner(const PlanningTask& task, const std::function<bool()>& interrupted);

}  // namespace keepout::app
