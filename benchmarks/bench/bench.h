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

/// One way to put a step together.
struct Combination {
  std::string index, activation, solver;
  std::optional<double> radius;  // of the motion sphere [mm]; none: as far as motions lead

  bool operator==(const Combination&) const = default;
};

/// What the user asked for; empty lists are up to us.
struct Selection {
  std::vector<std::string> indices = {}, activations = {}, solvers = {};
  std::vector<double> radii = {};  // [mm]
};

/// Whether any part was asked for by name.
bool names_parts(const Selection& selection);

/// Every combination of what was asked for, and where nothing was, of the reference: wide_bvh, the
/// rules paper and certified, active_set. If no part was asked for at all: each index with the
/// reference, each rule and solver with the reference, and what a user of the usual libraries would
/// put together, FCL's tree with SLSQP.
///
/// The certified rule looks as far as the motion leads whatever the radius: it is listed once.
/// Only parts that this build has; sorted by index, so that each is built once.
std::vector<Combination> combinations_of(const Selection& selection);

enum class Poses {
  contact,   // a tool that presses on the surface and slides along it, cycle after cycle
  unrelated  // all over the surface, as a planner asks
};

/// What to measure, and how thoroughly.
struct BenchmarkPlan {
  std::string command;  // that does it again
  std::vector<Subject> subjects;
  std::vector<Combination> combinations;  // those of one index together: it is built once
  std::size_t queries = 2500;             // of each combination, at most
  double seconds = 1.0;                   // after which one is asked no more: see measure()
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;  // of the motions, which are the same for all combinations on a mesh
};

/// One combination of parts on one mesh, as docs/records.md describes a row of `bench`.
using BenchmarkRow = Json;

/// A row with all of its members: zero, or null for what is not known. A row that is not verified
/// has no times, and a remark that says why.
BenchmarkRow new_row();

struct Benchmark {
  std::string date;     // ISO 8601, UTC
  std::string command;  // that does it again
  std::uint64_t seed = 0;
  Machine machine;
  std::map<std::string, std::string> parts = {};    // what each index, rule and solver is
  std::map<std::string, std::string> remarks = {};  // what an index does more or less than others
  std::size_t planned = 0;                          // rows; more than there are: it was stopped
  std::optional<double> others_cores = {};  // that other processes kept busy meanwhile, if known
  std::vector<BenchmarkRow> rows = {};
};

/// Measures every combination on every mesh until it is stopped, and prints the machine and a table
/// as it goes. What cannot be built, or gives a wrong answer, is not timed, and the row's remark
/// says why. The benchmark gets the rows that are finished, also where this throws Error: for a
/// mesh that is broken.
void run_benchmark(const BenchmarkPlan& plan, const StopSignal& stop, Benchmark& benchmark,
                   std::ostream& out);

/// Tells whether answers are the same, bit for bit: like FNV-1a, but of whole words.
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

/// What a step came to.
struct Answer {
  Answer(const Step& step) : status(step.status), motion(step.motion) {}
  bool operator==(const Answer&) const = default;

  Status status;
  Vec3 motion;
};

/// What every index and solver is held to, for one rule and radius on one mesh: brute force, in a
/// sample of the places; everywhere, the reference's guard, which is held to brute force too.
class Reference {
 public:
  /// The guard is one with these settings on an index that is right; its solver is our own. The
  /// motions must outlive this. Throws Error when the guard's own parts are not right: a fault of
  /// ours.
  Reference(std::shared_ptr<const SpatialIndex> right, std::shared_ptr<const Mesh> mesh,
            const MotionConstraintSettings& settings, std::span<const Motion> motions);

  /// Whether there is room for all triangles in reach. If not, ask no more of it.
  bool fits() const noexcept { return fits_; }

  /// The step that is expected for a motion.
  const Answer& answer(std::size_t motion);

  /// The hash of what a query finds there.
  std::uint64_t hits_hash(std::size_t motion);

  /// Whether a motion is accepted for its proof, and not because a solver says that it is the best.
  bool proves_motions() const noexcept { return proves_motions_; }

  const Mesh& mesh() const noexcept { return guard_.mesh(); }

  /// Where the rule looks at first, for each motion.
  std::span<const Ball> balls() const noexcept { return balls_; }

  /// Whether the index finds in every sampled ball what brute force finds, to the bit.
  bool is_found_by(const SpatialIndex& index);

  // What a query finds, for whoever makes one.
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
  std::vector<Answer> answers_;             // as far as they have been asked for
  std::vector<std::uint64_t> hits_hashes_;  // likewise
  bool fits_ = true;
};

/// Asks the constraint, which is put together as any user has it but takes tips as they are, for
/// the motions, in order and for so many seconds (or up to four times as many, to come to 1000
/// steps), stage by stage; then for the same steps as a whole; then the index for all triangles
/// where the rule looks for them at first. Each answer of each time is held to the reference
/// afterwards, and unless all are right no time is taken down.
///
/// Steps must be those of the reference bit for bit if the accuracy of the solver is 0; else within
/// so much of the length of the motion. A solver may give up, but not be wrong. Under a rule that
/// proves each motion, another solver's may be worse, of which the row tells. Triangles and their
/// closest points must be those of the reference bit for bit.
///
/// Of the `worse_share` of a row: with a solver other than the reference's, under a rule that
/// accepts a motion for its proof alone, a motion may be right, but farther from what was asked for
/// than the reference's, by more than a thousandth of it.
///
/// Fills the row from its queries on. Of no use when it was stopped meanwhile.
void measure(MotionConstraint& constraint, double accuracy, std::span<const Motion> motions,
             Reference& reference, double seconds, const StopSignal& stop, BenchmarkRow& row);

/// What is printed for a terminal: where it ran and what the columns mean; the columns' names; line
/// by line as the rows come in; and, in the end, the headline and how busy other processes kept the
/// machine.
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

/// The rows that the headline compares, of those timed without a remark: on the largest mesh, with
/// the largest sphere there, under one rule. Null if there is none.
struct Ranking {
  const BenchmarkRow* fastest = nullptr;
  const BenchmarkRow* slowest = nullptr;
};
Ranking ranking_of(const Benchmark& benchmark);

/// Returns how many groups of rows that differ only in the index made the same steps, as far as
/// their motions are the same, and how many rows are not compared.
Json step_groups_of(const Benchmark& benchmark);

/// Returns how many rows have wrong answers.
std::size_t wrong_rows(const Benchmark& benchmark);

struct Comparison;  // compare/compare.h

/// Returns true if no row has wrong answers and no parts disagree; `bench` fails otherwise.
bool is_right(const Benchmark& benchmark, const Comparison& comparison);

/// Returns a sentence with the times of the fastest and of the slowest row, and another if answers
/// are wrong.
std::string headline(const Benchmark& benchmark);

/// The record of it, as docs/records.md describes it.
Json json_of(const Benchmark& benchmark);

/// The rows, one a line, below a line of names; what was not measured is empty. Each says where it
/// was measured, so that files can be put together.
void write_csv(std::ostream& out, const Benchmark& benchmark);

/// Of `bench --speed` alone.
struct SpeedOptions {
  std::optional<std::size_t> largest = {};  // triangles of a third mesh; none: left out
  std::size_t histogram_steps = 10'000'000;
  bool quick = false;  // few of everything
};

struct BenchOptions {
  bool list = false;      // what there is to measure, and no more
  bool is_speed = false;  // the table of ratios instead: see bench_speed()
  SpeedOptions speed;
  std::vector<std::string> meshes;     // fixtures or files; empty: the bunny
  LoadOptions load = {};               // of the meshes that are named
  std::vector<std::size_t> triangles;  // sizes of the bunny; empty: up to `full`
  Selection selection;
  bool full = false;  // to 18 million triangles, and the skull; tens of minutes
  std::optional<std::size_t> queries;
  std::optional<double> seconds;
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;
  RecordFiles files = {.json = {}, .page = "keepout-bench.html"};
  std::string command;  // that does it again
};

/// Adds `keepout bench` and its options to the command line.
void add_bench(CLI::App& app, BenchOptions& options);

/// Measures every combination that was asked for on every mesh, prints a table as it goes, compares
/// the parts' answers on the first mesh, and writes a report and files. Throws Error before any
/// work when one could not be written, or there is no mesh of a name.
///
/// Gives the exit status: 0; failure if the answers of a row are wrong, or if the parts disagree;
/// or exit_interrupted when a signal stopped it. The rows that were finished are then written all
/// the same, marked as incomplete, and stderr tells what was kept and where; where there is none,
/// nothing is written. The same goes for a mesh that turns out to be broken: its error is thrown
/// after the rows of those before it are written.
int bench(const BenchOptions& options, std::ostream& out);

/// Measures the table of ratios that the engine is held to, prints it as it goes, and writes a
/// report and JSON, if asked for. What falls short is said, and is no error. A wish to stop ends it
/// after the family of rows at hand: what is measured is written, and said to be a part. The exit
/// status. Throws Error before any work when a file could not be written, or a fixture is missing.
int bench_speed(const BenchOptions& options, std::ostream& out);

/// Times all indices, rules and solvers on the mesh of a simulation, quickly, and compares their
/// answers. A signal stops it, and it keeps what is finished.
PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       const StopSignal& stop, std::ostream& out);

}  // namespace keepout::app
