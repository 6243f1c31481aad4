// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/index/query.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"
#include "keepout/solvers/recording_solver.h"
#include "record/record.h"
#include "shared/progress.h"
#include "shared/timing.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// Returns true if the work shall end early.
using Stopped = std::function<bool()>;
inline bool never() { return false; }

/// How thoroughly to compare.
struct CompareExtent {
  std::size_t poses = 60;        // for the indices, under each rule
  std::size_t problems = 2'000;  // for the solvers
  std::size_t pairs = 500;       // of tool and triangle, of each kind, for the narrow phases
  std::uint64_t seed = 1;
};

/// One index under one rule in a motion constraint as it is shipped, on the same poses as all
/// others, held to brute force.
struct IndexAgreement {
  std::string mesh = {}, index = {}, activation = {};
  bool searched = false;     // by a form of the rule that asks no query of it
  std::size_t poses = 0;     // each for one query and one step
  std::size_t missed = 0;    // triangles in reach that it did not give
  std::size_t invented = 0;  // triangles it gave twice, or that are not in reach, after refining
  double closest_point_error = 0.0;   // against exact arithmetic, the worst [mm]
  double plane_angle = 0.0;           // against brute force, the worst [rad]
  double step_difference = 0.0;       // against brute force, the worst [mm]
  std::size_t steps_that_differ = 0;  // in any bit, of the motion or of a plane
};

/// One solver on recorded problems.
struct SolverAgreement {
  std::string solver, activation;
  std::size_t posed = 0;     // problems that were recorded
  std::size_t problems = 0;  // of them, those that it got, evenly spread
  std::size_t optimal = 0;
  std::size_t infeasible = 0;
  std::size_t gave_up = 0;
  std::size_t wrong = 0;         // said optimal or infeasible where it was not
  double step_difference = 0.0;  // of the optimal ones, against active_set, relative to the reach
  double kkt_residual = 0.0;     // of the optimal ones, the worst
  Timing us = {};                // of a solve
  std::map<std::string, std::size_t> outcomes = {};  // what the library said, and what we found
};

/// A pair this close to a touch, on either side of it, is "touching": whether it is apart or
/// overlaps is finer than the tolerance of most libraries.
inline constexpr double touch = 1e-6;  // [mm]
inline constexpr const char* touch_text = "1e-6 mm";

/// One way to tell the distance between a convex tool and a triangle.
struct NarrowPhaseAgreement {
  std::string backend = {}, tool = {};
  std::string relation = {};  // "apart", "touching" (see touch), "overlapping"
  std::size_t pairs = 0;
  std::size_t failed = 0;        // no answer, or one that is no number
  std::size_t contradicted = 0;  // apart called overlapping, or the reverse
  double median_error = 0.0;     // of distance or depth, against the exact kernel [mm]
  double worst_error = 0.0;      // [mm]
  double worst_unproven = 0.0;   // of the exact distance, by a plane with its normal [mm]
  Timing us = {};                // of an answer
};

struct Comparison {
  bool complete = true;  // not if it was interrupted: then the rows that were finished
  std::vector<IndexAgreement> indices;
  std::vector<SolverAgreement> solvers;
  std::vector<NarrowPhaseAgreement> narrow_phases;
};

/// Returns true if no index differs in any bit and no solver is wrong. The narrow phases are not
/// keepout's, and may differ.
bool agree(const Comparison& comparison);

/// Returns a sentence on whether the parts agree, with the numbers of those that do not.
std::string headline(const Comparison& comparison);

/// Tables for a terminal, and the headline. Parts that were not compared are left out.
void print(std::ostream& out, const Comparison& comparison);

/// The record of it, as docs/records.md describes it; null where nothing was compared.
Json json_of(const Comparison& comparison);

// How well parts agree that can take each other's place. Each function shows on stderr how far it
// has come, and gives the rows that were finished when it was stopped.

/// Asks a part so many questions, one after the other, and judges each answer. Returns how long the
/// answers took [us]; empty if it was stopped.
template <class Ask, class Judge>
std::optional<Timing> ask_all(std::size_t count, Progress& progress, const Stopped& stopped,
                              Ask&& ask, Judge&& judge) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) {
    if (stopped()) return std::nullopt;
    const BenchClock::time_point start = BenchClock::now();
    auto answer = ask(i);
    times.push_back(microseconds_since(start));
    judge(i, std::move(answer));
    progress.advance();
  }
  return timing_of(times);
}

/// Whether two queries found the same there, to the last bit.
bool is_same(const Hit& one, const Hit& other);

/// What the indices are compared on.
struct IndexComparison {
  std::string mesh_name;
  std::shared_ptr<const Mesh> mesh;
  std::vector<std::string> indices, activations;
  std::size_t poses = 100;
  std::uint64_t seed = 1;
};

/// Builds the motion constraint that make_motion_constraint gives, with each index and each rule,
/// and holds what the index finds around the tip, the planes and the steps to brute force, and
/// closest points to exact arithmetic. Half of the poses are in contact, the others off the
/// surface, on vertices and on edges. `stopped` is asked before each pose, of brute force and of
/// each index, under each rule.
std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const Stopped& stopped = never);

/// The problems that closed-loop steps in contact pose: a hand presses the tip against the mesh and
/// drags it along, motions of 0.05 to 0.2 mm, a sphere of 5 mm, a margin of 0.2 mm. In every third
/// stroke seven joints move the tip, damped. Calls `stopped` before each stroke, and then returns
/// the problems until there. Throws Error for an unknown rule, and where such motions pose too few
/// problems, as on a mesh in another unit.
std::vector<RecordedProblem> record_problems(const std::shared_ptr<const Mesh>& mesh,
                                             const std::string& rule, std::size_t count,
                                             std::uint64_t seed, const Stopped& stopped = never);

/// Adds a row that contradicts some of the others: with weights of order 1 they add up to
/// 0 u >= a margin, 1e-6 to 1 of the motion asked for.
void contradict(RecordedProblem& problem, Random& random);

/// What the solvers are compared on.
struct SolverComparison {
  std::vector<std::string> rules;
  std::vector<std::string> solvers;
  std::size_t problems = 1000;              // recorded under each rule; a tenth made infeasible
  std::uint64_t seed = 1;                   // same seed, same problems
  std::map<std::string, std::size_t> most;  // problems for a slow solver: evenly from all
};

/// Poses the problems of closed-loop steps to each solver, times it, and judges each answer by the
/// KKT conditions and by active_set. A row for each rule and solver, in this order. Throws Error
/// for an unknown name.
std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped = never);

/// Holds each narrow phase of this build to the exact kernel: instrument-like tools of 2 mm to 5
/// mm, turned at random, at triangles of the mesh picked at random; as many pairs apart (up to 5
/// mm), touching (within 1e-6 mm) and overlapping (by 0.001 mm or more). All get the same pairs.
std::vector<NarrowPhaseAgreement> compare_narrow_phases(const Mesh& mesh, std::size_t pairs,
                                                        std::uint64_t seed,
                                                        const Stopped& stopped = never);

/// Everything that can take another's place, on the same input; as much as is finished when it is
/// stopped.
Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent, const Stopped& stopped);

struct CompareOptions {
  std::string mesh = "skull";  // a real fixture or a file
  LoadOptions load = {};
  CompareExtent extent;
  RecordFiles files;
  std::string command;  // that does it again
};

/// Adds `keepout compare` and its options to the command line.
void add_compare(CLI::App& app, CompareOptions& options);

/// Compares, and prints tables and a headline. Throws Error. For the exit status: nonzero when
/// parts disagree by more than they may, and exit_interrupted when a signal came first.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace keepout::app
