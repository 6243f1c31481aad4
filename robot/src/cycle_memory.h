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

/// A guide, and its memory from cycle to cycle.
struct GuideMemory {
  Guide guide;
  /// The depth inside its region that the last cycle certified; negative outside. [length or rad]
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
  /// Makes all memory, without a mesh.
  CycleMemory(const Instrument& instrument, Solver& solver, const InstrumentCapacity& capacity);

  const Instrument& instrument;
  Budget budget;          // of a cycle, for all meshes
  double largest_length;  // the largest accepted position of a prismatic joint or a mesh [length]
  double tolerance;       // tau: distances are equal within this [length]
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

  /// Makes the memory of all pairs of a body and a mesh, and forgets the last cycle. Allocates.
  /// Precondition: measure() after the meshes have changed.
  void prepare();
  /// Computes the tolerance and the largest length. The latter does not depend on the poses of the
  /// meshes, so repeated placing cannot raise it.
  void measure() noexcept;
  /// Returns the least margin beside any mesh. [length]
  double least_margin(const InstrumentOptions& options) const noexcept;
  /// Returns true if rounding hides the band, a guide's band, or the least margin minus the band.
  bool is_lost_in_rounding(const InstrumentOptions& options) const noexcept;
  /// Throws Error if an option is out of range, if the band is not below each margin, or if
  /// is_lost_in_rounding().
  void require_usable(const InstrumentOptions& options) const;
  /// Throws Error if rounding hides the band of a guide.
  void require_not_lost(const Guide& guide) const;
  /// Replaces the guides. Throws Error, and changes nothing: see InstrumentConstraint::set_guides.
  void set_guides(std::vector<Guide> all);
  /// Returns true if any mesh moves.
  bool is_moving() const noexcept {
    return std::any_of(meshes.begin(), meshes.end(), [](const MeshMemory& mesh) {
      return !mesh.velocity.linear.isZero(0.0) || !mesh.velocity.angular.isZero(0.0);
    });
  }
  /// Forgets all that cycles remember. Allocates nothing.
  void forget() noexcept;
  /// The certified clearances of the last cycle, of pairs and guides.
  using Certified = std::array<double, most_pairs + Guide::most>;
  /// Returns the certified clearances.
  Certified certified() const noexcept;
  /// Sets the certified clearances.
  void set_certified(const Certified& all) noexcept;
  /// Forgets the certified clearances.
  void forget_certified() noexcept;
  /// Forgets where the last step ended and the rows of its last problem, but not the triangles
  /// nearby.
  void forget_motion() noexcept;
};

/// Returns the tolerance of a guide's excess, if distances are equal within `tolerance`. Directions
/// have rounding errors of about 1e-15, and joint positions of about 1e-14 rad, independent of the
/// lengths. [length or rad]
inline double tolerance_of(const Guide& guide, double tolerance) noexcept {
  return guide.is_angular() ? 1e-12 : tolerance;
}

}  // namespace keepout
