// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/subject.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/query.h"
#include "record/record.h"
#include "shared/columns.h"
#include "shared/machine.h"
#include "shared/stop_signal.h"
#include "shared/timing.h"
#include "simulate/simulate.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// The parts of a step.
struct Combination {
  std::string index, activation, solver;
  std::optional<double> radius;  // of the motion sphere [mm]; empty: as far as motions go

  bool operator==(const Combination&) const = default;
};

/// The user's choice; an empty list selects the default.
struct Selection {
  std::vector<std::string> indices = {}, activations = {}, solvers = {};
  std::vector<double> radii = {};  // [mm]
};

/// Returns true if the user selected any part by name.
bool names_parts(const Selection& selection);

/// Returns every combination of the selected parts; an empty list stands for the reference parts:
/// wide_bvh, the rules paper and certified, active_set. If no part is selected: each index with the
/// reference, each rule and solver with the reference, and FCL's tree with SLSQP, as from usual
/// libraries.
///
/// The certified rule searches as far as the motion goes, whatever the radius: it is listed once.
/// Contains only parts of this build; sorted by index, so that each index is built once.
std::vector<Combination> combinations_of(const Selection& selection);

enum class Poses {
  contact,   // a tool that presses on the surface and slides along it, cycle after cycle
  unrelated  // all over the surface, as for a planner
};

/// The plan of a benchmark.
struct BenchmarkPlan {
  std::string command;  // the command line that repeats it
  std::vector<Subject> subjects;
  std::vector<Combination> combinations;  // sorted by index, so that each is built once
  std::size_t queries = 2500;             // of each combination, at most
  double seconds = 1.0;                   // time for one combination: see measure()
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;  // of the motions, which are the same for all combinations on a mesh
};

/// One combination of parts on one mesh, as docs/records.md describes a row of `bench`.
using BenchmarkRow = Json;

/// Returns a row with all members: zero, or null for unknown values. A row that is not verified has
/// no times, and its remark gives the reason.
BenchmarkRow new_row();

struct Benchmark {
  std::string date;     // ISO 8601, UTC
  std::string command;  // the command line that repeats it
  std::uint64_t seed = 0;
  Machine machine;
  std::map<std::string, std::string> parts = {};    // the description of each index, rule and
                                                    // solver
  std::map<std::string, std::string> remarks = {};  // what an index does more or less than others
  std::size_t planned = 0;                          // rows; more than there are after a stop
  std::optional<double> others_cores = {};          // that other processes kept busy, if known
  std::vector<BenchmarkRow> rows = {};
};

/// Measures every combination on every mesh until it is stopped; prints the machine and a table. A
/// part that cannot be built or gives a wrong answer is not timed, and the row's remark gives the
/// reason. Throws Error for a broken mesh; `benchmark` then has the finished rows.
void run_benchmark(const BenchmarkPlan& plan, const StopSignal& stop, Benchmark& benchmark,
                   std::ostream& out);

/// A hash for the bitwise comparison of answers: like FNV-1a, but of whole words.
class BitHash {
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001B3;
    value_ ^= value_ >> 32;
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x + 0.0)); }  // -0 is 0

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325;
};

/// The result of a step.
struct Answer {
  Answer(const Step& step) : status(step.status), motion(step.motion) {}
  bool operator==(const Answer&) const = default;

  Status status;
  Vec3 motion;
};

/// The expected answers for one rule and radius on one mesh, for all indices and solvers. They come
/// from the reference constraint, which is compared with brute force at a sample of places.
class Reference {
 public:
  /// Makes the reference constraint with these settings on a correct index; its solver is keepout's
  /// own. The motions must outlive this. Throws Error if the constraint's own parts are wrong: a
  /// bug in keepout.
  Reference(std::shared_ptr<const SpatialIndex> right, std::shared_ptr<const Mesh> mesh,
            const MotionConstraintSettings& settings, std::span<const Motion> motions);

  /// True if all triangles in reach fit the capacity. Otherwise call no other function.
  bool fits() const noexcept { return fits_; }

  /// Returns the expected step for a motion.
  const Answer& answer(std::size_t motion);

  /// Returns the hash of the hits of a query for a motion.
  std::uint64_t hits_hash(std::size_t motion);

  /// True if the rule accepts a motion because of its proof, and not because of the solver's claim.
  bool proves_motions() const noexcept { return proves_motions_; }

  const Mesh& mesh() const noexcept { return guard_.mesh(); }

  /// Returns the ball that the rule searches first, for each motion.
  std::span<const Ball> balls() const noexcept { return balls_; }

  /// True if the index finds in every sampled ball bitwise the hits of brute force.
  bool is_found_by(const SpatialIndex& index);

  // Buffers for the result of a query.
  TriangleBuffer candidates;
  HitBuffer hits;

 private:
  struct Sample {
    std::size_t motion;
    std::vector<Hit> hits;
  };

  std::span<const Hit> hits_of(const SpatialIndex& index, const Ball& ball);

  MotionConstraint guard_;
  bool proves_motions_;
  std::span<const Motion> motions_;
  std::vector<Ball> balls_;
  std::vector<Sample> samples_;
  std::vector<Answer> answers_;             // computed on first use
  std::vector<std::uint64_t> hits_hashes_;  // computed on first use
  bool fits_ = true;
};

/// Times a constraint that takes tips as they are, in three rounds. First, stage by stage: steps
/// for the motions in order, for `seconds`, or up to four times as long if there are fewer than
/// 1000 steps. Second, the same steps as a whole. Third, the index: all triangles that the rule
/// searches first. Then compares all answers with the reference. If any is wrong, the row gets no
/// times.
///
/// If the solver's accuracy is 0, steps must be bitwise those of the reference; otherwise they must
/// agree within `accuracy` times the length of the motion. A solver may give up, but must not be
/// wrong. Triangles and their closest points must be bitwise those of the reference.
///
/// The member `worse_share` of a row counts motions that are correct but worse: farther from the
/// desired motion than the reference's, by more than a thousandth of it. They occur with other
/// solvers, under a rule that accepts motions by proof.
///
/// Fills the row from its queries on. After a stop the row is unusable.
void measure(MotionConstraint& constraint, double accuracy, std::span<const Motion> motions,
             Reference& reference, double seconds, const StopSignal& stop, BenchmarkRow& row);

/// Output for a terminal: the machine and the columns' meaning; the columns' names; a row; the
/// headline and the load by other processes.
void print_machine(std::ostream& out, const Machine& machine);
void print_table_head(std::ostream& out);
void print_table_row(std::ostream& out, const BenchmarkRow& row);
void print_headline(std::ostream& out, const Benchmark& benchmark);

/// A pair of an index and a solver. The headline compares these two if both were timed.
struct Pair {
  const char* index;
  const char* solver;
};
inline constexpr std::array pairs{Pair{"wide_bvh", "active_set"},
                                  Pair{"fcl_obbrss", "nlopt_slsqp"}};

/// The rows that the headline compares: timed, without a remark, on the largest mesh, with the
/// largest sphere there, under one rule. Null if no row qualifies.
struct Ranking {
  const BenchmarkRow* fastest = nullptr;
  const BenchmarkRow* slowest = nullptr;
};
Ranking ranking_of(const Benchmark& benchmark);

/// Compares rows that differ only in the index. Returns how many groups made the same steps, as far
/// as their motions are the same, and how many rows are not compared.
Json step_groups_of(const Benchmark& benchmark);

/// Returns how many rows have wrong answers.
std::size_t wrong_rows(const Benchmark& benchmark);

struct Comparison;  // compare/compare.h

/// Returns true if no row has wrong answers and no parts disagree; `bench` fails otherwise.
bool is_right(const Benchmark& benchmark, const Comparison& comparison);

/// Returns a sentence with the times of the fastest and of the slowest row, and another if answers
/// are wrong.
std::string headline(const Benchmark& benchmark);

/// Returns the record, as docs/records.md describes it.
Json json_of(const Benchmark& benchmark);

/// Writes a line of names and a line for each row; values that were not measured are empty. Each
/// row has its machine, so that files can be combined.
void write_csv(std::ostream& out, const Benchmark& benchmark);

/// Writes the table of `--sweep`, in the same form. It has the mesh, the parts, the costs of the
/// index, and the median and 99 % of a query, of its stages and of the step.
void write_short_csv(std::ostream& out, const Benchmark& benchmark);

/// Options of `bench --speed` only.
struct SpeedOptions {
  std::optional<std::size_t> largest = {};  // triangles of a third mesh, if any
  std::size_t histogram_steps = 10'000'000;
  bool quick = false;  // a short run
};

struct BenchOptions {
  bool list = false;      // only list the parts that can be measured
  bool is_speed = false;  // the table of ratios instead: see bench_speed()
  SpeedOptions speed;
  std::vector<std::string> meshes;     // sample meshes or files; empty: the bunny
  LoadOptions load = {};               // of the named meshes
  std::vector<std::size_t> triangles;  // sizes of the bunny; empty: up to `full`
  Selection selection;
  bool sweep = false;  // every index, on sizes of the bunny in half decades; a short CSV
  bool full = false;   // to 18 million triangles, and the skull; tens of minutes
  std::optional<std::size_t> queries;
  std::optional<double> seconds;
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;
  RecordFiles files = {.json = {}, .page = "keepout-bench.html"};
  std::string command;  // the command line that repeats it
};

/// Adds `keepout bench` and its options to the command line.
void add_bench(CLI::App& app, BenchOptions& options);

/// Measures every selected combination on every mesh, prints a table, compares the parts' answers
/// on the first mesh, and writes a report and files. Throws Error before any work if a file cannot
/// be written, or if a mesh does not exist.
///
/// Returns the exit status: 0; failure if the answers of a row are wrong or the parts disagree;
/// exit_interrupted after a signal. After a signal it writes the finished rows, marked as
/// incomplete, and reports the files on stderr; without finished rows it writes nothing. If a mesh
/// is broken, it writes the rows of the meshes before it, and then throws the mesh's Error.
int bench(const BenchOptions& options, std::ostream& out);

/// Measures the table of required ratios, prints it, and writes a report and JSON if requested.
/// Reports ratios that fall short; they are not an error. A stop takes effect after the current
/// family of rows; the output is then marked as incomplete. Returns the exit status. Throws Error
/// before any work if a file cannot be written, or if a sample mesh is missing.
int bench_speed(const BenchOptions& options, std::ostream& out);

/// Times all indices, rules and solvers on the mesh of a simulation, quickly, and compares their
/// answers. After a signal it keeps the finished rows.
PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       const StopSignal& stop, std::ostream& out);

}  // namespace keepout::app
