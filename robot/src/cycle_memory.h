// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "certificate.h"
#include "keepout/buffer.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/guide.h"
#include "keepout/step/solver.h"
#include "pair_memory.h"
#include "row.h"

namespace keepout {

/// A guide, and what the cycles remember of it.
struct GuideMemory {
  Guide guide;
  /// By how much inside its region the last cycle certified it; below 0: outside. [length or rad]
  double certified;
};

/// The owner and the triangle of a row that was active in the last problem solved: the next cycle
/// starts with a row of each.
struct WarmRow {
  std::size_t owner;  // see Row
  TriangleId triangle;
};

/// The constants of one cycle.
struct CycleConstants {
  const InstrumentOptions& options;
  bool meshes_move;  // in this cycle
};

/// The memory of the cycles of one instrument, shared by the parts of a cycle. Made once.
struct CycleMemory {
  /// Makes all memory; there is no mesh yet.
  CycleMemory(const Instrument& instrument, Solver& solver, const InstrumentCapacity& capacity);

  const Instrument& instrument;
  Budget budget;          // of a cycle, for all meshes
  double largest_length;  // of a prismatic joint's position or a mesh's; larger ones are rejected
  double tolerance;       // distances are equal within this [length]
  PointMotion trial_motion;  // from the start of the cycle, by the increment on trial
  // PairWatch: all bodies with the first mesh, all with the second, and so on.
  std::vector<MeshMemory> meshes;
  std::vector<PairMemory> pairs;
  std::vector<Certificate::Obstacle> obstacles;    // to the last motion judged, of each pair
  Buffer<DegradedClearance> degraded{most_pairs};  // of the last cycle
  // GuideWatch.
  std::vector<GuideMemory> guides;
  std::vector<GuideState> guide_states;  // of the last cycle
  // WorkingRows.
  Buffer<Row> rows;
  Buffer<Row> earlier_rows;  // while better ones are tried
  Buffer<WarmRow> warm;
  // JointProblem.
  Solver& solver;
  std::vector<double> matrix;  // of all rows, row by row
  std::vector<double> bounds;
  JointVector increment;  // the result

  /// Makes the memory of the pairs of a body and a mesh, and forgets all. Allocates. Precondition:
  /// measure() after the meshes have changed.
  void prepare();
  /// Computes the tolerance and the largest length. The latter does not depend on the poses of the
  /// meshes, so repeated placing cannot raise it.
  void measure() noexcept;
  /// Returns the least margin beside any mesh. [length]
  double least_margin(const InstrumentOptions& options) const noexcept;
  /// Returns true if rounding hides the band, a guide's band, or what the least margin is beyond
  /// the band.
  bool is_lost_in_rounding(const InstrumentOptions& options) const noexcept;
  /// Throws Error unless all options are in range and rounding leaves something of the margins.
  void require_usable(const InstrumentOptions& options) const;
  /// Throws Error if rounding hides the band of a guide.
  void require_not_lost(const Guide& guide) const;
  /// Replaces the guides. Throws Error, and changes nothing, as InstrumentConstraint::set_guides
  /// does.
  void set_guides(std::vector<Guide> all);
  /// Returns true if any mesh moves.
  bool is_moving() const noexcept {
    return std::any_of(meshes.begin(), meshes.end(), [](const MeshMemory& mesh) {
      return !mesh.velocity.linear.isZero(0.0) || !mesh.velocity.angular.isZero(0.0);
    });
  }
  /// Forgets all. Allocates nothing.
  void forget() noexcept;
  /// The clearances that were certified last, of pairs and guides.
  using Certified = std::array<double, most_pairs + Guide::most>;
  /// Returns them.
  Certified certified() const noexcept;
  /// Sets them.
  void set_certified(const Certified& all) noexcept;
  /// Forgets them.
  void forget_certified() noexcept;
  /// Forgets where the last step ended and the rows of its last problem, but not the triangles
  /// nearby.
  void forget_motion() noexcept;
};

/// Returns the tolerance of a guide's excess, if distances are equal within `tolerance`. A
/// direction is rounded by some 1e-15, and joint positions by some 1e-14 rad, whatever the lengths.
/// [length or rad]
inline double tolerance_of(const Guide& guide, double tolerance) noexcept {
  return guide.is_angular() ? 1e-12 : tolerance;
}

}  // namespace keepout
