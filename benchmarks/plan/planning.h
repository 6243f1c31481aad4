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
  /// True if keepout answers for its paths.
  bool is_keepouts() const noexcept { return kind == Kind::certified || slides(); }
  bool slides() const noexcept { return kind == Kind::sliding; }
};

/// States that straight motions join: of a tip its coordinates [mm], of an instrument the positions
/// of its joints.
using Path = std::vector<std::vector<double>>;

/// From where to where a tip or an instrument is to be led.
struct PlanningProblem {
  std::size_t number = 0;  // from 1
  std::vector<double> start = {}, goal = {};
  Pose base = {};     // of the instrument
  Json members = {};  // of its runs in the record: all of this, and how hard it is
};

/// What a planner asks in a space; without `motions` it samples, as OMPL does by itself.
struct Checks {
  ompl::base::StateValidityCheckerPtr states;
  ompl::base::MotionValidatorPtr motions = {};
};

/// Plans on one mesh, for a tip or for a whole instrument. All spaces are RealVectorStateSpaces.
class Planning {
 public:
  virtual ~Planning() = default;
  virtual const Scene& scene() const = 0;
  /// True if the mesh is planned within, not around.
  virtual bool is_within() const { return false; }
  /// Draws the problems, by a rule that knows no planner; each has a solution. Throws Error if it
  /// finds too few. After a stop, returns those drawn so far.
  virtual std::vector<PlanningProblem> draw(const StopSignal& stop) = 0;
  /// Makes what checks and judges the runs of a problem, which must outlive them.
  virtual void open(const PlanningProblem& problem) = 0;
  virtual ompl::base::StateSpacePtr space() const = 0;
  virtual Checks checks(const ompl::base::SpaceInformationPtr& space, const Checker& checker) = 0;
  /// Makes the planner of a checker that slides; null: such a checker has none here.
  virtual ompl::base::PlannerPtr sliding(const ompl::base::SpaceInformationPtr&) { return {}; }
  /// Returns what the oracle finds on a path of one state or more, by its name in the record.
  virtual Json judge(const Path& path) = 0;
};

/// Plans in a scene for a tip, or for the instrument of options.robot. `options` must outlive it.
std::unique_ptr<Planning> planning_of_a_tip(const PlanOptions& options, Scene scene);
std::unique_ptr<Planning> planning_of_an_instrument(const PlanOptions& options, Scene scene);

/// The scene of a plan for a tip: a mesh, and its free side.
struct TipScene {
  Scene scene;
  bool is_within = false;     // planned within the mesh, not around it
  bool starts_below = false;  // only in the lowest tenth of the bounds, along z
  Box bounds = {};            // of the state space [mm]
};

/// Draws problems for a tip, each with a solution that keeps the clearance:
///
/// 1. A grid of 1/200 of the mesh's diagonal, or of 1/300 of the bounds, is flooded (FreeCells):
/// around the mesh from a corner
///    of the bounds, within it from the widest of 1000 places drawn in it, in its lowest tenth
///    where starts are below.
/// 2. Start and goal are drawn evenly among the cells reached that are no farther from the mesh
///    than five times the clearance; starts as the scene has it.
/// 3. A pair is taken when the way along the grid is at least a quarter of the diagonal long and
///    1.3 times as long as in the open, and the straight way from one to the other touches the
///    mesh.
/// Returns those drawn so far after a stop.
std::vector<PlanningProblem> draw_problems(TipScene& where, double clearance, std::size_t count,
                                           std::uint64_t seed, const StopSignal& stop);

/// The checkers that are compared: for a tip sampled at each resolution, the same widened, then
/// both of keepout's; for an instrument sampled and certified. No two have the same name.
std::vector<Checker> checkers_of(const PlanOptions& options);

// A run is an entry of the record's "runs": one planner on one problem under one checker.

/// True if the oracle finds nothing wrong with the path of a run that is solved.
bool is_valid(const Json& run);

/// True if the checker of a run is one of keepout's.
bool is_keepouts(const Json& run);

/// The record of it: see docs/records.md. `complete`: it was not stopped.
Json record_of(const PlanOptions& options, std::span<const std::unique_ptr<Planning>> plannings,
               Json runs, bool complete);

/// A row for each mesh and checker, in the order of the runs.
void print_summaries(std::ostream& out, const Json& runs);

}  // namespace keepout::app
