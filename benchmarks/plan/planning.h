// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plan/ompl_run.h"
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
  /// True if keepout answers for its paths.
  bool is_keepouts() const noexcept { return kind == Kind::certified || slides(); }
  bool slides() const noexcept { return kind == Kind::sliding; }
};

/// Plans on one mesh, for a tip or for a whole instrument.
class Planning {
 public:
  virtual ~Planning() = default;
  virtual const Scene& scene() const = 0;
  /// True if the mesh is planned within, not around.
  virtual bool is_within() const { return false; }
  /// Draws the problems. Throws Error if it finds too few.
  virtual std::vector<PlanningProblem> draw() = 0;
  /// Makes what checks and judges the runs of a problem, which must outlive them.
  virtual void open(const PlanningProblem& problem) = 0;
  /// Makes a planner under a checker, in a space of its own. The timer must outlive it.
  virtual ompl::base::PlannerPtr planner(const Checker& checker, CheckTimer& timer) = 0;
  /// Returns what the oracle finds on a path, by its name in the record; null if the path is empty.
  virtual Json judge(const Path& path) = 0;
};

/// The meshes that the options name, each to be planned for a tip. `options` must outlive them.
std::vector<std::unique_ptr<Planning>> plannings_of_a_tip(const PlanOptions& options);
/// Like plannings_of_a_tip, but for the instrument of options.robot.
std::vector<std::unique_ptr<Planning>> plannings_of_an_instrument(const PlanOptions& options);

/// The checkers that are compared: for a tip sampled at each resolution, the same widened, then
/// both of keepout's; for an instrument sampled and certified.
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
