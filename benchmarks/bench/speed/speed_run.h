// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/bench.h"
#include "bench/speed/guarded_mesh.h"
#include "bench/speed/speed_record.h"
#include "keepout/error.h"
#include "keepout/fixtures/motions.h"
#include "shared/progress.h"

namespace keepout::app {

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

/// What became of an attempt to time something: its times, or why there are none.
struct Attempt {
  std::optional<MeasuredSide> side = {};
  std::string refusal = {};
};

/// What the timing gives; the message of an Error that it throws.
template <class Timed>
Attempt attempted(Timed&& timing) {
  try {
    return {timing()};
  } catch (const Error& error) {
    return {.refusal = error.what()};
  }
}

/// Figures that other rows are set against.
struct Baselines {
  Attempt libraries = {};  // FCL's tree and SLSQP, the paper's rule at 5 mm
  Attempt contact = {};    // certified, ours
  Attempt free = {};       // the same, in free space
};

/// One run of the table, as its families of rows are measured one after the other.
struct SpeedRun {
  const SpeedOptions& options;
  const Effort& effort;
  std::size_t triangles;  // of the bunny, on which all is measured unless said
  Progress& progress;
  std::ostream& out;
  SpeedRecord record = {};
  Baselines baselines = {};

  /// The same motions for whoever asks for them.
  Random random() const { return Random(record.seed); }

  /// As many motions in contact as our steps are timed on.
  std::vector<Motion> contact(const IndexedMesh& on, const MotionKind& kind = {}) const;

  /// Says what is being measured.
  void show(const std::string& work) { progress.show(work); }

  /// Takes down a row, and prints it.
  void add(SpeedRow row);
};

/// numerator / denominator, of the medians. Where a side is missing, so is the figure, and the
/// remark says why.
SpeedRow ratio(std::string work, std::string compared, const Demand& demand,
               const Attempt& numerator, const Attempt& denominator);

constexpr Demand at_least(double value) { return {Demand::Sense::at_least, value}; }
constexpr Demand at_most(double value) { return {Demand::Sense::at_most, value}; }

/// The steps of one on these motions; refused where the other's are not the same: see
/// disagreement().
Attempt time_steps(std::string name, MotionConstraint& one, MotionConstraint& other,
                   std::span<const Motion> motions, int passes, double accuracy = 0.0);

/// Our certified step on these motions; refused where it is not the same on the same index that
/// only answers queries, bit for bit.
Attempt time_certified(const SpeedRun& run, const IndexedMesh& on, const std::string& name,
                       double margin, std::span<const Motion> motions);

/// The same on a tool that slides along the surface, at the margin.
Attempt in_contact(SpeedRun& run, const IndexedMesh& on, const MotionKind& kind = {});

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
void measure_sphere_queries(SpeedRun& run, const IndexedMesh& on);

/// A whole step with the paper's rule, in contact: ours, and what the usual libraries would make.
void measure_paper_steps(SpeedRun& run, const IndexedMesh& on);

/// A whole certified step, in contact and in free space, at two margins and lengths of motion.
void measure_certified_steps(SpeedRun& run, const IndexedMesh& on);

/// Tips all over the surface, as a planner asks.
void measure_unrelated_states(SpeedRun& run, const IndexedMesh& on);

/// Steps before each of which the caches are emptied.
void measure_cold_caches(SpeedRun& run, const IndexedMesh& on);

/// What the index takes to be built, to be refitted, and to hold.
void measure_index_costs(SpeedRun& run, const IndexedMesh& on);

/// Page faults, allocations and locks of steps after warm-up, and a histogram of their times.
void measure_steadiness(SpeedRun& run, const IndexedMesh& on);

/// The inside of a sphere: at the centre all triangles are equally far.
void measure_concave_sphere(SpeedRun& run);

/// From a file to the first step.
void measure_first_step(SpeedRun& run);

/// Certified steps on meshes of 16 and 100 million triangles.
void measure_large_meshes(SpeedRun& run);

}  // namespace keepout::app
