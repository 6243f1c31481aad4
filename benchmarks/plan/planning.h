// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/Planner.h>

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/pose.h"
#include "plan/plan.h"
#include "shared/columns.h"
#include "shared/stop_signal.h"
#include "verify/scene.h"

namespace keepout::app {

/// The method that checks motions for a planner.
struct Checker {
  enum class Kind : std::uint8_t {
    sampled,    // OMPL's own: places along the motion, each by its exact distance from the mesh
    widened,    // as sampled, with half the spacing of places added to the clearance: a proof as
                // well
    certified,  // keepout's motion validator: proves the whole motion
    sliding     // keepout's projecting steer, in a planner of its own with two trees
  };
  Kind kind = Kind::certified;
  double resolution = 0.0;  // if sampled: spacing of places, as a fraction of the space's extent

  /// Returns "sampled 1 %", "widened 1 %", "certified" or "sliding".
  std::string name() const;
  /// True if keepout proves its paths.
  bool is_keepouts() const noexcept { return kind == Kind::certified || slides(); }
  bool slides() const noexcept { return kind == Kind::sliding; }
};

/// States with straight motions between them: the coordinates of a tip [mm], or the joint positions
/// of an instrument.
using Path = std::vector<std::vector<double>>;

/// The start and the goal for a tip or an instrument.
struct PlanningProblem {
  std::size_t number = 0;  // from 1
  std::vector<double> start = {}, goal = {};
  Pose base = {};     // of the instrument
  Json members = {};  // of its runs in the record: these values, and measures of difficulty
};

/// The checks of a planner in a space; without `motions`, OMPL samples motions itself.
struct Checks {
  ompl::base::StateValidityCheckerPtr states;
  ompl::base::MotionValidatorPtr motions = {};
};

/// Plans on one mesh, for a tip or for a whole instrument. All spaces are RealVectorStateSpaces.
class Planning {
 public:
  virtual ~Planning() = default;
  virtual const Scene& scene() const = 0;
  /// Returns true if the plan is within the mesh, not around it.
  virtual bool is_within() const { return false; }
  /// Draws the problems by a rule that uses no planner; each has a solution. Throws Error if it
  /// finds too few. After a stop, returns those drawn so far.
  virtual std::vector<PlanningProblem> draw(const StopSignal& stop) = 0;
  /// Prepares the checks and the judge of a problem. The problem must outlive its runs.
  virtual void open(const PlanningProblem& problem) = 0;
  virtual ompl::base::StateSpacePtr space() const = 0;
  virtual Checks checks(const ompl::base::SpaceInformationPtr& space, const Checker& checker) = 0;
  /// Returns the planner of a sliding checker; null without one.
  virtual ompl::base::PlannerPtr sliding(const ompl::base::SpaceInformationPtr&) { return {}; }
  /// Returns the oracle's findings on a path of one state or more, by their names in the record.
  virtual Json judge(const Path& path) = 0;
};

/// Plans in a scene for a tip, or for the instrument of options.robot. `options` must outlive it.
std::unique_ptr<Planning> planning_of_a_tip(const PlanOptions& options, Scene scene);
std::unique_ptr<Planning> planning_of_an_instrument(const PlanOptions& options, Scene scene);

/// The scene of a plan for a tip: a mesh, and its free side.
struct TipScene {
  Scene scene;
  bool is_within = false;     // plan within the mesh, not around it
  bool starts_below = false;  // starts only in the lowest tenth of the bounds, along z
  Box bounds = {};            // of the state space [mm]
};

/// Draws problems for a tip, each with a solution that maintains the clearance:
///
/// 1. Floods a grid of 1/200 of the mesh's diagonal, or of 1/300 of the bounds (FreeCells). Around
///    a mesh it starts at a corner of the bounds. Within a mesh it starts at the widest of 1000
///    random places, in the lowest tenth if `starts_below`.
/// 2. Draws start and goal evenly from the reached cells that are no farther from the mesh than
///    five times the clearance; starts as the scene requires.
/// 3. Takes a pair if the straight motion touches the mesh. The path along the grid must be at
///    least a quarter of the diagonal, and 1.3 times as long as in free space.
///
/// After a stop, returns the problems so far.
std::vector<PlanningProblem> draw_problems(TipScene& where, double clearance, std::size_t count,
                                           std::uint64_t seed, const StopSignal& stop);

/// The checkers that are compared: for a tip sampled at each resolution, the same widened, then
/// both of keepout's; for an instrument sampled and certified. No two have the same name.
std::vector<Checker> checkers_of(const PlanOptions& options);

// A run is an entry of the record's "runs": one planner on one problem under one checker.

/// Returns true if the oracle finds no fault in the path of a solved run.
bool is_valid(const Json& run);

/// Returns true if the checker of a run is one of keepout's.
bool is_keepouts(const Json& run);

/// Returns the record: see docs/records.md. `complete`: it was not stopped.
Json record_of(const PlanOptions& options, std::span<const std::unique_ptr<Planning>> plannings,
               Json runs, bool complete);

/// Prints a row for each mesh and checker, in the order of the runs.
void print_summaries(std::ostream& out, const Json& runs);

}  // namespace keepout::app
