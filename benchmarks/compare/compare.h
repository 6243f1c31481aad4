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

/// Returns true if the work must end early.
using Stopped = std::function<bool()>;
inline bool never() { return false; }

/// The extent of a comparison.
struct CompareExtent {
  std::size_t poses = 60;        // for the indices, under each rule
  std::size_t problems = 2'000;  // for the solvers
  std::size_t pairs = 500;       // of tool and triangle, of each relation, for the narrow phases
  std::uint64_t seed = 1;
};

/// The comparison of one index under one rule with brute force, in a motion constraint as users
/// have it. All indices get the same poses.
struct IndexAgreement {
  std::string mesh = {}, index = {}, activation = {};
  bool searched = false;     // by a form of the rule that makes no queries
  std::size_t poses = 0;     // each for one query and one step
  std::size_t missed = 0;    // triangles in reach that it did not return
  std::size_t invented = 0;  // triangles returned twice, or not in reach, after the exact test
  double closest_point_error = 0.0;   // from exact arithmetic, the worst [mm]
  double plane_angle = 0.0;           // from brute force, the worst [rad]
  double step_difference = 0.0;       // from brute force, the worst [mm]
  std::size_t steps_that_differ = 0;  // in any bit, of the motion or of a plane
};

/// One solver on recorded problems.
struct SolverAgreement {
  std::string solver, activation;
  std::size_t posed = 0;     // problems that were recorded
  std::size_t problems = 0;  // of these, the problems for this solver, evenly spread
  std::size_t optimal = 0;
  std::size_t infeasible = 0;
  std::size_t gave_up = 0;
  std::size_t wrong = 0;         // claimed optimal or infeasible, but it was not
  double step_difference = 0.0;  // of the optimal ones, from active_set, relative to the motion
  double kkt_residual = 0.0;     // of the optimal ones, the worst
  Timing us = {};                // of a solve
  std::map<std::string, std::size_t> outcomes = {};  // the library's claim and our finding
};

/// A pair closer to contact than this is "touching", whether apart or overlapping: most libraries
/// have a coarser tolerance.
inline constexpr double touch = 1e-6;  // [mm]
inline constexpr const char* touch_text = "1e-6 mm";

/// The comparison of one narrow phase with the exact kernel, for one tool and relation.
struct NarrowPhaseAgreement {
  std::string backend = {}, tool = {};
  std::string relation = {};  // "apart", "touching" (see touch), "overlapping"
  std::size_t pairs = 0;
  std::size_t failed = 0;        // no answer, or not a finite one
  std::size_t contradicted = 0;  // apart called overlapping, or the reverse
  double median_error = 0.0;     // of distance or depth, from the exact kernel [mm]
  double worst_error = 0.0;      // [mm]
  double worst_unproven = 0.0;   // of the exact distance, not proved by a plane with the answer's
                                 // normal [mm]
  Timing us = {};                // of an answer
};

struct Comparison {
  bool complete = true;  // false after a stop: only the finished rows
  std::vector<IndexAgreement> indices;
  std::vector<SolverAgreement> solvers;
  std::vector<NarrowPhaseAgreement> narrow_phases;
};

/// Returns true if all indices are bitwise identical and no solver is wrong. The narrow phases are
/// from other libraries and may differ.
bool agree(const Comparison& comparison);

/// Returns a sentence on whether the parts agree, with the numbers of those that do not.
std::string headline(const Comparison& comparison);

/// Prints tables and the headline. Leaves out parts that were not compared.
void print(std::ostream& out, const Comparison& comparison);

/// Returns the record, as docs/records.md describes it; null if nothing was compared.
Json json_of(const Comparison& comparison);

// Comparisons of parts that can replace each other. Each function shows its progress on stderr, and
// returns the finished rows after a stop.

/// Asks a part `count` questions, one after the other, and judges each answer. Returns the times of
/// the answers [µs]; empty after a stop.
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

/// Returns true if two hits are bitwise identical.
bool is_same(const Hit& one, const Hit& other);

/// The input of a comparison of indices.
struct IndexComparison {
  std::string mesh_name;
  std::shared_ptr<const Mesh> mesh;
  std::vector<std::string> indices, activations;
  std::size_t poses = 100;
  std::uint64_t seed = 1;
};

/// Builds the motion constraint of make_motion_constraint with each index and each rule. Compares
/// the hits around the tip, the planes and the steps with brute force, and closest points with
/// exact arithmetic. Half of the poses are in contact; the others are near the surface, on vertices
/// and on edges. Calls `stopped` before each pose.
std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const Stopped& stopped = never);

/// Records the problems of closed-loop steps in contact: an operator presses the tip against the
/// mesh and drags it along. Motions are 0.05 to 0.2 mm, the sphere is 5 mm, the margin 0.2 mm. In
/// every third stroke, seven joints move the tip, with damping. Calls `stopped` before each stroke;
/// after a stop, returns the problems so far. Throws Error for an unknown rule, and if the motions
/// yield too few problems, as on a mesh in another unit.
std::vector<RecordedProblem> record_problems(const std::shared_ptr<const Mesh>& mesh,
                                             const std::string& rule, std::size_t count,
                                             std::uint64_t seed, const Stopped& stopped = never);

/// Adds a row that contradicts some of the others: with weights of order 1 their sum is 0 u >= a
/// positive bound, 1e-6 to 1 of the desired motion.
void contradict(RecordedProblem& problem, Random& random);

/// The input of a comparison of solvers.
struct SolverComparison {
  std::vector<std::string> rules;
  std::vector<std::string> solvers;
  std::size_t problems = 1000;              // recorded under each rule; a tenth made infeasible
  std::uint64_t seed = 1;                   // same seed, same problems
  std::map<std::string, std::size_t> most;  // problems for a slow solver, evenly spread
};

/// Gives the problems of closed-loop steps to each solver, times it, and judges each answer by the
/// KKT conditions and by active_set. Returns a row for each rule and solver, in this order. Throws
/// Error for an unknown name.
std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped = never);

/// Compares each narrow phase of this build with the exact kernel. Tools like instruments, 2 to 5
/// mm in size, have random orientations near random triangles of the mesh. There are equally many
/// pairs apart (up to 5 mm), touching (within 1e-6 mm) and overlapping (by 0.001 mm or more). All
/// narrow phases get the same pairs.
std::vector<NarrowPhaseAgreement> compare_narrow_phases(const Mesh& mesh, std::size_t pairs,
                                                        std::uint64_t seed,
                                                        const Stopped& stopped = never);

/// Compares all parts that can replace each other, on the same input. After a stop, returns what is
/// finished.
Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent, const Stopped& stopped);

struct CompareOptions {
  std::string mesh = "skull";  // a sample mesh or a file
  LoadOptions load = {};
  CompareExtent extent;
  RecordFiles files;
  std::string command;  // the command line that repeats it
};

/// Adds `keepout compare` and its options to the command line.
void add_compare(CLI::App& app, CompareOptions& options);

/// Compares the parts and prints tables and a headline. Returns the exit status: nonzero if parts
/// disagree more than they may, exit_interrupted after a signal. Throws Error.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace keepout::app
