// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/ompl/guard_pool.h"
#include "plan/plan.h"
#include "plan/problems.h"
#include "shared/columns.h"

namespace keepout::app {

// A planner's way through one problem: how it comes about, what the oracle says of it, and how many
// of them are told of.

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
  std::vector<Vec3> points = {};  // empty unless solved [mm]
};

/// The same task yields the same path, unless time ran out. `interrupted`: asked by the planner as
/// it goes on; ends it when true. Not for two threads at once: OMPL's seed is the process's.
PlannedPath run_planner(const PlanningTask& task, const std::function<bool()>& interrupted);

/// What the oracle says of a path, over the whole of each straight piece.
struct PathVerdict {
  bool enters = false;         // some piece touches the mesh
  bool is_too_near = false;    // some piece comes nearer than is allowed
  std::size_t bad_pieces = 0;  // that do either
  double clearance = 0.0;      // the least distance from the mesh [mm]
  double length = 0.0;         // [mm]

  bool is_valid() const noexcept { return !enters && !is_too_near; }
};

/// The least distance that docs/certified-step.md promises of the clearance: m - 3 tau. [mm]
double least_distance(const Scene& scene, const PlanOptions& options);

/// `least`: the distance allowed; anything exactly below it is too near. [mm] Precondition: two
/// points.
PathVerdict judge_path(const Scene& scene, std::span<const Vec3> points, double least);

/// The lengths of a path that is not valid that come too near: to half a millimetre.
std::vector<std::vector<Vec3>> lengths_too_near(const Scene& scene, std::span<const Vec3> points,
                                                double least);

/// One problem under one checker.
struct PlanningRun {
  std::string mesh;
  std::string planner;  // that was run
  Checker checker;
  Problem problem;
  PlannedPath path;
  PathVerdict verdict;                           // of a solved one
  std::vector<std::vector<Vec3>> too_near = {};  // the lengths of it that are not valid [mm]
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

/// Of two in the middle their mean; no number where there is none.
double median(std::vector<double> values);

/// Planner, time, clearance and seed, in words.
std::string lead(const PlanOptions& options);

/// In the order of the runs.
std::vector<PlanningSummary> summaries(const std::vector<PlanningRun>& runs);

/// What came out, in a sentence.
std::string headline(const std::vector<PlanningRun>& runs);

void print_table(std::ostream& out, const std::vector<PlanningSummary>& rows);

/// The record of it: see docs/records.md. `complete`: it was not stopped.
Json record_of(const PlanOptions& options, const std::vector<PlanningScene>& scenes,
               const std::vector<PlanningRun>& runs, bool complete);

}  // namespace keepout::app
