// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "increment_box.h"
#include "joint_problem.h"
#include "working_rows.h"

namespace keepout {

/// The memory of the cycles of one instrument: one member for each part of a cycle. Made once.
struct CycleMemory {
  /// Makes all memory; there is no mesh yet.
  CycleMemory(const Instrument& instrument, Solver& solver, const InstrumentCapacity& capacity);

  const Instrument& instrument;
  Budget budget;            // of a cycle, for all meshes
  double largest_position;  // of a prismatic joint or a mesh: larger ones are rejected [length]
  double tolerance;         // distances are equal within this [length]
  PointMotion motion;
  PairMemories bodies;
  GuideMemories guides;
  RowMemory rows;
  ProblemMemory problem;
  std::vector<Certificate::Obstacle> obstacles;  // of each pair on the last trial
  JointVector increment;                         // the result

  /// Returns the largest distance of joint k (1..n) from 0 that a cycle accepts. [rad or length]
  double largest_position_of(int k) const noexcept {
    return IncrementBox::largest_position(instrument.chain(), k, largest_position);
  }
  /// Makes the parts that depend on the meshes, and forgets all. Allocates.
  void prepare();
  /// Computes the tolerance and the largest position. The latter does not depend on the poses of
  /// the meshes, so repeated placing cannot raise it.
  void measure() noexcept;
  /// Returns the least margin beside any mesh. [length]
  double least_margin(const InstrumentOptions& options) const noexcept;
  /// Returns true if rounding hides the least margin, the band, or a guide's band.
  bool is_lost_in_rounding(const InstrumentOptions& options) const noexcept;
  /// Throws Error unless all options are in range and rounding leaves something of the margins.
  void require_usable(const InstrumentOptions& options) const;
  /// Returns true if any mesh moves.
  bool is_moving() const noexcept {
    return std::any_of(bodies.meshes.begin(), bodies.meshes.end(), [](const MeshMemory& mesh) {
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
  /// Forgets where the last step ended and the rows that limited it, but not the triangles nearby.
  void forget_motion() noexcept;
};

}  // namespace keepout
