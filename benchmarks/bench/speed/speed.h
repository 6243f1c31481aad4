// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sched.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/bench.h"
#include "bench/speed/guarded_mesh.h"
#include "keepout/error.h"
#include "keepout/fixtures/motions.h"
#include "shared/progress.h"
#include "shared/timing.h"

namespace keepout::app {

/// Counts times in memory of a fixed size. Covers 1 ns to 4 s, with eight bins of equal width for
/// each doubling, so that a bin resolves a time to an eighth.
///
/// Source of the layout of bins: G. Tene, HdrHistogram.
class TimeHistogram {
 public:
  static constexpr unsigned bins_of_a_doubling = 8;
  static constexpr std::size_t bins = 32 * bins_of_a_doubling;

  /// Counts a time; times out of range go to the first or the last bin. [ns]
  void add(std::uint64_t ns) noexcept;

  std::uint64_t count(std::size_t bin) const noexcept { return counts_[bin]; }
  std::uint64_t total() const noexcept { return total_; }
  std::uint64_t longest() const noexcept { return longest_; }  // [ns]

  /// Returns the start of a bin, which is the end of the one before. [ns]
  static double beginning_of(std::size_t bin) noexcept;
  static std::size_t bin_of(std::uint64_t ns) noexcept;

  /// Returns the end of the bin that contains the percentile; share 0.999 for 99.9 %. Empty if no
  /// time was added. [ns]
  std::optional<double> percentile(double share) const noexcept;

 private:
  std::array<std::uint64_t, bins> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t longest_ = 0;
};

/// The times of one side of a comparison, or why it was not timed. Below 0.2 µs, reading the clock
/// would distort the median; it is then that of batches, each divided by its length. All other
/// percentiles are of single calls and include reading the clock.
struct MeasuredSide {
  std::string name = {};
  Timing us = {};
  std::size_t batch = 1;     // calls in a batch, for the median
  std::string refusal = {};  // empty: it was timed
  bool is_wrong = false;     // refused because of a wrong answer
};

/// Returns the smaller of each percentile of two passes over the same work: other load on the
/// machine only adds time.
Timing least_of(const Timing& one, const Timing& other);

/// Times do_one(0) ... do_one(count - 1) in batches, in up to `passes` passes; makes no further
/// pass if they take long. Returns the least of each percentile. Precondition: batch <= count.
template <class Work>
Timing timed_in_batches(std::size_t batch, std::size_t count, int passes, Work&& do_one) {
  constexpr double patience = 5e6;  // longer work is not repeated [us]
  std::optional<Timing> least;
  std::vector<double> samples;
  samples.reserve(count / batch);
  const BenchClock::time_point begin = BenchClock::now();
  for (int pass = 0; pass < passes && (pass == 0 || microseconds_since(begin) < patience); ++pass) {
    samples.clear();
    for (std::size_t first = 0; first + batch <= count; first += batch) {
      const BenchClock::time_point start = BenchClock::now();
      for (std::size_t i = first; i < first + batch; ++i) do_one(i);
      samples.push_back(microseconds_since(start) / static_cast<double>(batch));
    }
    const Timing timing = timing_of(samples);
    least = least ? least_of(*least, timing) : timing;
  }
  return *least;
}

/// Times calls one by one; if they are very short, takes the median from batches.
template <class Work>
MeasuredSide timed(std::string name, std::size_t count, int passes, Work&& do_one) {
  constexpr double worth_batching = 0.2;  // below, reading the clock would distort the time [us]
  constexpr std::size_t batch = 32;
  MeasuredSide side{.name = std::move(name), .us = timed_in_batches(1, count, passes, do_one)};
  if (side.us.p50 >= worth_batching || count < batch) return side;
  side.us.p50 = timed_in_batches(batch, count, passes, do_one).p50;
  side.batch = batch;
  return side;
}

/// Times work as a whole: the median of `times` calls.
template <class Work>
MeasuredSide timed_whole(std::string name, std::size_t times, Work&& work) {
  return timed(std::move(name), times, 1, [&](std::size_t) { work(); });
}

/// Times the work of another library once. If it throws an Error, the message is the refusal.
template <class Work>
MeasuredSide attempted(std::string name, Work&& work) {
  try {
    return timed_whole(std::move(name), 1, work);
  } catch (const Error& error) {
    return {.refusal = error.what()};
  }
}

/// The required value of a figure.
inline Json at_least(double value) { return {{"at_least", value}}; }
inline Json at_most(double value) { return {{"at_most", value}}; }

/// A row of the table: a figure, its required value, and the times behind it.
struct SpeedRow {
  std::string work = {};              // the work and its mesh
  std::string compared = {};          // "FCL's tree / wide_bvh"
  Json demand = {};                   // at_least() or at_most()
  std::string unit = "x";             // of the figure; x: a ratio
  std::optional<double> figure = {};  // empty: not measured, and the remark says why
  std::vector<MeasuredSide> sides = {};
  std::string remark = {};
  bool is_wrong = false;  // a side gave a wrong answer

  bool is_met() const {
    return figure && (demand.contains("at_least") ? *figure >= demand["at_least"]
                                                  : *figure <= demand["at_most"]);
  }
};

/// Returns the row for numerator / denominator, of the medians. If a side is missing, there is no
/// figure, and the remark gives the reason.
SpeedRow ratio(std::string work, std::string compared, const Json& demand,
               const MeasuredSide& numerator, const MeasuredSide& denominator);

/// The times of a sphere query with one index, for information.
struct QueryFigures {
  std::string index = {};
  double radius = 0.0;      // [mm]
  double found_mean = 0.0;  // triangles within the ball
  MeasuredSide candidates = {};
  MeasuredSide answer = {};       // those within the ball, by the engine's kernel: ids only
  MeasuredSide lean_answer = {};  // those within the ball, by the shortest code that decides the
                                  // same
};

/// The extent of the measurements.
struct Effort {
  std::size_t queries;     // places of a sphere query
  std::size_t steps;       // of keepout
  std::size_t slow_steps;  // of other libraries
  std::size_t cold_steps;  // before each of which the caches are emptied
  std::size_t builds;      // of an index
  int passes;              // over the same work; the fastest counts
  const char* file;        // sample mesh to load
};

/// A run of the table; the families of rows are measured in turn.
struct SpeedRun {
  struct Stopped {};  // thrown between two rows, after a signal

  const BenchOptions& options;
  const Effort& effort;
  std::size_t triangles;  // of the bunny, which all rows use unless stated
  Progress& progress;
  const StopSignal& stop;
  std::ostream& out;
  std::string mesh;  // the name of that bunny
  IndexedMesh bunny = {};
  std::string date = date_now();  // ISO 8601, UTC
  Machine machine = this_machine();
  std::vector<SpeedRow> rows = {};
  std::vector<QueryFigures> queries = {};
  Json histogram = nullptr;             // the times of very many steps, and of an empty loop
  std::string histogram_words = {};     // how long these steps took
  bool complete = true;                 // false after a stop: some rows are missing
  std::vector<std::string> wrong = {};  // the parts that gave wrong answers

  // Times that other rows are compared with.
  MeasuredSide libraries = {};     // FCL's tree and SLSQP, the paper's rule at 5 mm
  MeasuredSide contact_side = {};  // certified, keepout
  MeasuredSide free_side = {};     // certified, keepout, in free space

  /// Returns a new generator with the same seed, so that all parts get the same motions.
  Random random() const { return Random(options.seed); }

  /// Returns as many motions in contact as keepout's steps are timed on.
  std::vector<Motion> contact(const IndexedMesh& on, const MotionKind& kind = {}) const {
    return pressed_motions(on, effort.steps, kind, random());
  }

  /// Shows the work that is being measured.
  /// Shows the current work. Throws Stopped after a signal.
  void show(const std::string& work) {
    if (stop.has_come()) throw Stopped{};
    progress.show(work);
  }

  /// Stores a row and prints it.
  void add(SpeedRow row);
  void set_histogram(const TimeHistogram& steps, const TimeHistogram& nothing);
};

/// Output for a terminal: the machine; at the end the query times of every index, and the rows that
/// fall short.
void print_head(const SpeedRun& run);
void print_summary(const SpeedRun& run);

/// Returns the record: see docs/records.md.
Json record_of(const SpeedRun& run);

/// Times the steps of `one` on these motions; refuses if those of `other` differ: see
/// disagreement().
MeasuredSide time_steps(std::string name, MotionConstraint& one, MotionConstraint& other,
                        std::span<const Motion> motions, int passes, double accuracy = 0.0);

/// Times keepout's certified step on these motions. Refuses unless it is bitwise identical on the
/// same index with queries only.
MeasuredSide time_certified(const SpeedRun& run, const IndexedMesh& on, const std::string& name,
                            double margin, std::span<const Motion> motions);

/// Times certified steps of a tool that slides along the surface, at the margin.
MeasuredSide in_contact(SpeedRun& run, const IndexedMesh& on, const MotionKind& kind = {});

/// An index to compare with, and how many times as long it must take.
struct Rival {
  std::string_view index;
  std::string_view name;
  double query_at_5_mm, query_at_1_mm, build;
};

inline constexpr std::array rivals{Rival{"fcl_obbrss", "FCL's tree", 38.0, 10.0, 15.0},
                                   Rival{"embree", "Embree", 10.0, 5.0, 3.0}};

/// Throws Error if the index disagrees with brute force at a sample of places near the mesh.
void hold_to_brute_force(const IndexedMesh& on, Random random);

// The families of rows. Each verifies its parts first; a wrong answer is not timed, and the row
// says so.

/// Finds triangles within a ball at random places near the surface, ids only, with every index. If
/// the index is not exact, tests its candidates one by one.
void measure_sphere_queries(SpeedRun& run);

/// Times a whole step with the paper's rule, in contact: keepout, and the usual libraries.
void measure_paper_steps(SpeedRun& run);

/// Times a whole certified step, in contact and in free space, for two margins and lengths of
/// motion.
void measure_certified_steps(SpeedRun& run);

/// Times steps of tips all over the surface, as for a planner.
void measure_unrelated_states(SpeedRun& run);

/// Times steps with empty caches.
void measure_cold_caches(SpeedRun& run);

/// Measures build, refit and memory of the index.
void measure_index_costs(SpeedRun& run);

/// Counts page faults, allocations and locks of steps after warm-up, and makes a histogram of
/// times.
void measure_steadiness(SpeedRun& run);

/// Times steps inside a sphere: at the center all triangles are equally far.
void measure_concave_sphere(SpeedRun& run);

/// Times the start, from a file to the first step.
void measure_first_step(SpeedRun& run);

/// Times certified steps on meshes of 16 and 100 million triangles.
void measure_large_meshes(SpeedRun& run);

// Resources of this process while it measures.

/// Binds the calling thread, and threads that it starts, to `count` cores: the current one, and
/// others that the process was allowed at its start. The destructor undoes it. If the system
/// refuses, it does nothing, and holds() is false.
class OnCores {
 public:
  explicit OnCores(unsigned count) noexcept;
  ~OnCores();
  OnCores(const OnCores&) = delete;
  OnCores& operator=(const OnCores&) = delete;

  bool holds() const noexcept { return holds_; }

 private:
  cpu_set_t before_;
  bool holds_ = false;
};

/// Resets peak_memory(). If the system refuses, the peak counts from the start of the process.
void reset_peak_memory();

/// Returns the page faults of this thread since its start.
std::uint64_t page_faults();

/// The calls of heap and lock functions by this thread since its start. The program replaces
/// malloc, its relatives, and pthread's mutexes and locks by functions that count.
struct CallCounts {
  std::size_t allocations = 0;
  std::size_t locks = 0;
};

/// True if this build counts. One with a sanitizer does not, because the sanitizer replaces the
/// same functions.
bool counts_calls() noexcept;

CallCounts calls_of_this_thread() noexcept;

}  // namespace keepout::app
