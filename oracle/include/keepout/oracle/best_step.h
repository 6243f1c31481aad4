// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/ids.h"
#include "keepout/mesh/mesh.h"

namespace keepout::oracle {

/// The best safe straight step: the reference for the optimality of other steps.
struct BestStep {
  Vec3 motion;   // safe, and the nearest known to the desired one [length]
  double cost;   // |motion - desired| [length]
  double bound;  // no safe step costs less [length]
};

/// Returns the safe motion nearest to `desired`. On a safe motion, the tip moves straight from
/// `tip` to the end and stays at least `margin` from every triangle. From a triangle that is nearer
/// at the start, it stays at least as far as at the start.
///
/// Branch and bound over the directions finds the best of all motions. `cost` exceeds `bound` by at
/// most 1e-4 |desired|, unless the search stops at its limit of cells. (This can happen if a whole
/// curve of motions is equally good.) The cost is usually exact to 1e-6 |desired|, and the
/// clearance holds to 1e-12 of the problem's size. A call takes milliseconds.
///
/// Preconditions: all numbers are finite, and the tip is not on a triangle. `near` contains every
/// triangle within |desired| / 2 + margin of tip + desired / 2, and may contain others.
BestStep best_step(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
                   const Vec3& desired, double margin);

}  // namespace keepout::oracle
