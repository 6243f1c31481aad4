// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/ids.h"
#include "keepout/mesh/mesh.h"

namespace keepout::oracle {

/// The best safe straight step: what a step that gives away something is measured against.
struct BestStep {
  Vec3 motion;   // safe, and nearest to the desired one as far as is known [length]
  double cost;   // |motion - desired| [length]
  double bound;  // no safe step costs less [length]
};

/// The motion nearest to `desired` on whose whole way, from `tip` straight to its end, the tip
/// stays at least `margin` from every triangle. A triangle that is nearer already may not come
/// nearer yet.
///
/// Found by branch and bound over the directions, so it is the best of all and not of some: `cost`
/// exceeds `bound` by at most 1e-4 |desired|, unless the search gives up (it may where a whole
/// curve of motions is equally good; the two then tell by how much). As a rule the cost is exact to
/// 1e-6 |desired|, and the clearance is kept to 1e-12 of the problem's size. Milliseconds a call.
///
/// Preconditions: all is finite, the tip is on no triangle, and `near` names every triangle within
/// |desired| / 2 + margin of tip + desired / 2; others do no harm.
BestStep best_step(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
                   const Vec3& desired, double margin);

}  // namespace keepout::oracle
