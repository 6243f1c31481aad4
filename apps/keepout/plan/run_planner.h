// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/ompl/guard_pool.h"
#include "plan/plan.h"
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
  bool is_keepouts() const noexcept { return kind == Kind::certified || slides(); }
  bool slides() const noexcept { return kind == Kind::sliding; }
};

/// Sampled at each resolution, the same widened, then both of keepout's.
std::vector<Checker> checkers(std::span<const double> resolutions);

/// One planner on one problem under one checker. What it refers to must outlive it.
struct PlanningTask {
  const PlanOptions& options;
  const PlanningScene& where;
  const Problem& problem;
  Checker checker;
  std::shared_ptr<GuardPool> guards;  // of keepout's checkers, for the options' clearance

  /// The sliding checker brings a planner of its own.
  std::string planner() const { return checker.slides() ? "SlidingConnect" : options.planner; }
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
