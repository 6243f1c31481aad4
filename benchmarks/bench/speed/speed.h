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

/// Counts times in memory of a fixed size: 1 ns to 4 s, each doubling in eight bins of equal width,
/// so that a bin tells a time to an eighth.
///
/// Source: G. Tene, HdrHistogram, of the layout of bins.
class TimeHistogram {
 public:
  static constexpr unsigned bins_of_a_doubling = 8;
  static constexpr std::size_t bins = 32 * bins_of_a_doubling;

  /// What lies outside is counted in the first or the last bin. [ns]
  void add(std::uint64_t ns) noexcept;

  std::uint64_t count(std::size_t bin) const noexcept { return counts_[bin]; }
  std::uint64_t total() const noexcept { return total_; }
  std::uint64_t longest() const noexcept { return longest_; }  // [ns]

  /// Where a bin begins; it ends where the next begins. [ns]
  static double beginning_of(std::size_t bin) noexcept;
  static std::size_t bin_of(std::uint64_t ns) noexcept;

  /// The end of the bin that the share of all times reaches, 0.999 of them for one; none, if
  /// nothing was added. [ns]
  std::optional<double> percentile(double share) const noexcept;

 private:
  std::array<std::uint64_t, bins> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t longest_ = 0;
};

/// What was timed under one name, or why it was not. The median of what takes less than 0.2 us is
/// that of batches, each divided by its length, for reading the clock would be a good part of it;
/// the percentiles beside it are of single ones, the clock's reading included.
struct MeasuredSide {
  std::string name = {};
  Timing us = {};
  std::size_t batch = 1;     // how many were timed at once, for the median
  std::string refusal = {};  // empty: it was timed
  bool is_wrong = false;     // refused because of a wrong answer
};

/// The lesser of each percentile of two passes over the same work: what else the machine did
/// meanwhile only ever adds.
Timing least_of(const Timing& one, const Timing& other);

/// Times do_one(0) ... do_one(count - 1), one after the other, in batches of so many, so many times
/// over, or once if it takes long: the least of each percentile. Precondition: batch <= count.
template <class Work>
Timing timed_in_batches(std::size_t batch, std::size_t count, int passes, Work&& do_one) {
  constexpr double patience = 5e6;  // what takes longer is not repeated [us]
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

/// The same one by one, and the median of what is too short for that in batches.
template <class Work>
MeasuredSide timed(std::string name, std::size_t count, int passes, Work&& do_one) {
  constexpr double worth_batching = 0.2;  // below, reading the clock would be a good part [us]
  constexpr std::size_t batch = 32;
  MeasuredSide side{.name = std::move(name), .us = timed_in_batches(1, count, passes, do_one)};
  if (side.us.p50 >= worth_batching || count < batch) return side;
  side.us.p50 = timed_in_batches(batch, count, passes, do_one).p50;
  side.batch = batch;
  return side;
}

/// How long the work takes as a whole: the median of so many times.
template <class Work>
MeasuredSide timed_whole(std::string name, std::size_t times, Work&& work) {
  return timed(std::move(name), times, 1, [&](std::size_t) { work(); });
}

/// The same once, of another library. An Error that it throws is the refusal.
template <class Work>
MeasuredSide attempted(std::string name, Work&& work) {
  try {
    return timed_whole(std::move(name), 1, work);
  } catch (const Error& error) {
    return {.refusal = error.what()};
  }
}

/// What a figure must come to.
inline Json at_least(double value) { return {{"at_least", value}}; }
inline Json at_most(double value) { return {{"at_most", value}}; }

/// One line of the table: a figure, what it must come to, and what it was made of.
struct SpeedRow {
  std::string work = {};              // what is done, on what
  std::string compared = {};          // "FCL's tree / wide_bvh"
  Json demand = {};                   // at_least() or at_most()
  std::string unit = "x";             // of the figure; x: a ratio
  std::optional<double> figure = {};  // none: not measured, and the remark says why
  std::vector<MeasuredSide> sides = {};
  std::string remark = {};
  bool is_wrong = false;  // a side gave a wrong answer

  bool is_met() const {
    return figure && (demand.contains("at_least") ? *figure >= demand["at_least"]
                                                  : *figure <= demand["at_most"]);
  }
};

/// numerator / denominator, of the medians. Where a side is missing, so is the figure, and the
/// remark says why.
SpeedRow ratio(std::string work, std::string compared, const Json& demand,
               const MeasuredSide& numerator, const MeasuredSide& denominator);

/// What one index takes for a sphere query, for information.
struct QueryFigures {
  std::string index = {};
  double radius = 0.0;      // [mm]
  double found_mean = 0.0;  // triangles within the ball
  MeasuredSide candidates = {};
  MeasuredSide answer = {};       // those of them within the ball, by the engine's kernel: ids only
  MeasuredSide lean_answer = {};  // the same by the least code that decides the same
};

/// How much of everything is measured.
struct Effort {
  std::size_t queries;     // places of a sphere query
  std::size_t steps;       // of ours
  std::size_t slow_steps;  // of the libraries
  std::size_t cold_steps;  // between which the caches are emptied
  std::size_t builds;      // of an index
  int passes;              // over the same work, of which the least counts
  const char* file;        // fixture that is loaded
};

/// One run of the table, as its families of rows are measured one after the other.
struct SpeedRun {
  const BenchOptions& options;
  const Effort& effort;
  std::size_t triangles;  // of the bunny, on which all is measured unless said
  Progress& progress;
  std::ostream& out;
  std::string mesh;  // the name of that bunny
  IndexedMesh bunny = {};
  std::string date = date_now();  // ISO 8601, UTC
  Machine machine = this_machine();
  std::vector<SpeedRow> rows = {};
  std::vector<QueryFigures> queries = {};
  Json histogram = nullptr;  // the times of a great many steps, beside those of an empty loop
  std::string histogram_words = {};  // how long these steps took
  bool complete = true;  // or interrupted: the rows are those that were measured until then
  std::vector<std::string> wrong = {};  // what gave wrong answers

  // Figures that other rows are set against.
  MeasuredSide libraries = {};     // FCL's tree and SLSQP, the paper's rule at 5 mm
  MeasuredSide contact_side = {};  // certified, ours
  MeasuredSide free_side = {};     // the same, in free space

  /// The same motions for whoever asks for them.
  Random random() const { return Random(options.seed); }

  /// As many motions in contact as our steps are timed on.
  std::vector<Motion> contact(const IndexedMesh& on, const MotionKind& kind = {}) const {
    return pressed_motions(on, effort.steps, kind, random());
  }

  /// Says what is being measured.
  void show(const std::string& work) { progress.show(work); }

  /// Takes down a row, and prints it.
  void add(SpeedRow row);
  void set_histogram(const TimeHistogram& steps, const TimeHistogram& nothing);
};

/// For a terminal: where it ran; and in the end what every index takes for a query, and which rows
/// fall short.
void print_head(const SpeedRun& run);
void print_summary(const SpeedRun& run);

/// The record of it: see docs/records.md.
Json record_of(const SpeedRun& run);

/// The steps of one on these motions; refused where the other's are not the same: see
/// disagreement().
MeasuredSide time_steps(std::string name, MotionConstraint& one, MotionConstraint& other,
                        std::span<const Motion> motions, int passes, double accuracy = 0.0);

/// Our certified step on these motions; refused where it is not the same on the same index that
/// only answers queries, bit for bit.
MeasuredSide time_certified(const SpeedRun& run, const IndexedMesh& on, const std::string& name,
                            double margin, std::span<const Motion> motions);

/// The same on a tool that slides along the surface, at the margin.
MeasuredSide in_contact(SpeedRun& run, const IndexedMesh& on, const MotionKind& kind = {});

/// An index that ours is set against, and how many times as long it must take.
struct Rival {
  std::string_view index;
  std::string_view name;
  double query_at_5_mm, query_at_1_mm, build;
};

inline constexpr std::array rivals{Rival{"fcl_obbrss", "FCL's tree", 38.0, 10.0, 15.0},
                                   Rival{"embree", "Embree", 10.0, 5.0, 3.0}};

/// Throws Error when the index does not find what brute force finds, at some places near the mesh.
void hold_to_brute_force(const IndexedMesh& on, Random random);

// The families of rows. Each verifies what it times beforehand: a wrong answer is not timed, and
// the row says so.

/// Triangles within a ball at random places near the surface, ids only: every index, and its
/// candidates by one scalar exact test where it is not exact by itself.
void measure_sphere_queries(SpeedRun& run);

/// A whole step with the paper's rule, in contact: ours, and what the usual libraries would make.
void measure_paper_steps(SpeedRun& run);

/// A whole certified step, in contact and in free space, at two margins and lengths of motion.
void measure_certified_steps(SpeedRun& run);

/// Tips all over the surface, as a planner asks.
void measure_unrelated_states(SpeedRun& run);

/// Steps before each of which the caches are emptied.
void measure_cold_caches(SpeedRun& run);

/// What the index takes to be built, to be refitted, and to hold.
void measure_index_costs(SpeedRun& run);

/// Page faults, allocations and locks of steps after warm-up, and a histogram of their times.
void measure_steadiness(SpeedRun& run);

/// The inside of a sphere: at the center all triangles are equally far.
void measure_concave_sphere(SpeedRun& run);

/// From a file to the first step.
void measure_first_step(SpeedRun& run);

/// Certified steps on meshes of 16 and 100 million triangles.
void measure_large_meshes(SpeedRun& run);

// What the system gives to this process while it measures, and what it tells of it.

/// Keeps the calling thread, and those that it starts, on so many cores: the one that it is on, and
/// others that it was allowed when the process began. Then as before. Where the system refuses,
/// nothing happens, and holds() says so.
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

/// Begins anew what peak_memory() tells. Where the system refuses, the peak is that since the
/// process began.
void reset_peak_memory();

/// Of this thread since it began.
std::uint64_t page_faults();

/// What this thread has asked of the heap and of locks since it began. malloc and its kin, and
/// pthread's mutexes and locks, are counted as they are called, by standing in for them.
struct CallCounts {
  std::size_t allocations = 0;
  std::size_t locks = 0;
};

/// Whether this build counts: one with a sanitizer does not, for that stands in for them too.
bool counts_calls() noexcept;

CallCounts calls_of_this_thread() noexcept;

}  // namespace keepout::app
