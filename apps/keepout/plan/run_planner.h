// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/ompl/guard_pool.h"
#include "plan/problems.h"

namespace keepout::app {

/// How a planner learns whether a motion is valid.
struct Checker {
  enum class Kind : std::uint8_t {
    sampled,    // OMPL's own: places along the motion, each by its exact distance from the mesh
    widened,    // the same with half the way between places added to the clearance: a proof, too
    certified,  // keepout's motion validator: the whole of it is proven
    sliding     // keepout's projecting steer, in a planner of its own with two trees
  };
  Kind kind = Kind::certified;
  double resolution = 0.0;  // if sampled: between places, in shares of the space's extent

  /// "sampled 1 %", "widened 1 %", "certified", "sliding".
  std::string name() const;
  /// Whether keepout answers for its paths.
  bool is_keepouts() const noexcept { return kind == Kind::certified || kind == Kind::sliding; }
};

/// Sampled at each resolution, the same widened, then both of keepout's.
std::vector<Checker> checkers(std::span<const double> resolutions);

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
