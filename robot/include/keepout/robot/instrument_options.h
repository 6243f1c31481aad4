// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/robot/instrument.h"

namespace keepout {

/// On which motion the certificate is taken.
enum class CertifiedMotion : std::uint8_t {
  actual,     // the one that the joints make
  linearised  // of points on straight lines, p + s J dq: what others do. Unsafe; for comparison
              // only
};

/// What stays the same from cycle to cycle.
struct InstrumentOptions {
  /// Distance to keep beyond each body's radius, from all meshes that have no margin of their own,
  /// > band [length]
  double margin = 0.2;
  /// What is held back of the margin, so that curved motions along a surface are proven: certified
  /// is margin - band. A wide band costs progress, never safety. See recommended_band. [length]
  double band = 0.002;
  double period = 1e-3;    // of a cycle: what velocity limits are multiplied by [s], > 0
  double recovery = 0.05;  // how far a body that is too close is led away in a cycle, >= 0 [length]
  /// Bodies come on slower where they are nearer to the margin than that, so that they touch it
  /// softly: a way of d left to it, they use up no more than d period / slowing_time in a cycle.
  /// What comes on is the instrument: a mesh that does is not fled. 0: nowhere. [length]
  double slowing_within = 0.0;
  double slowing_time = 0.05;  // how long the approach takes to come to an end, > 0 [s]
  /// Weight of |dq|^2 beside the task of the flange, >= 0: what singular poses give way to. A
  /// prismatic joint counts as a radian when it moves by orientation_weight, or by a length of 1
  /// where that is 0. [length^2]
  double damping = 0.1;
  /// What a turn of the flange counts beside its way, in lengths, >= 0: a radian off is as bad as
  /// so much. 0: only its origin is steered. [length / rad]
  double orientation_weight = 20.0;
  int refinements = 1;  // how often planes are turned towards a better motion, >= 0
  /// Whether bodies that no step has led to where they are have to be on the free side of a
  /// watertight mesh: by its winding, as tips are (docs/conventions.md).
  bool check_sides = true;
  CertifiedMotion certified = CertifiedMotion::actual;  // nothing else is safe
};

/// Room for the largest cycle.
struct InstrumentCapacity {
  static constexpr std::size_t most_meshes = 8;  // to be kept out of

  std::size_t triangles = std::size_t{1} << 14;  // of one mesh, near one body
  std::size_t planes = 128;                      // posed at the same time
  /// The work of a cycle, whatever happens in it: see Budget. What cannot be proven with it is not
  /// moved. 0: Capacity::looks_of_a_walk on an index that walks by itself, as wide_bvh, and
  /// Capacity::looks_of_queries on others, of which more is asked.
  std::size_t looks = 0;
};

/// A band that absorbs the curvature of every motion that the joints' limits admit in a cycle of
/// `period` > 0 seconds: an eighth of the largest bend of any body's point, at least `least`.
/// Infinite without limits. [length]
double recommended_band(const Instrument& instrument, double period, double least = 0.002);

}  // namespace keepout
