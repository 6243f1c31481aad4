// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <memory>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/step/side_memory.h"
#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

/// A mesh, its pose, and its memory from cycle to cycle.
struct MeshMemory {
  std::unique_ptr<Neighborhood> neighborhood;  // mesh, index and candidates; CycleMemory's budget
  double own_margin;                           // 0: the mesh has the margin of the options [length]
  bool is_watertight;
  RelativeMotion motion;                           // of the instrument, in the mesh's frame
  Pose pose = {};                                  // at the start of the next cycle
  Twist velocity = {};                             // [length/s], [rad/s]
  bool has_refused_pose = false;                   // the last call of place() was rejected
  SideMemory<Instrument::most_points> sides = {};  // of all points, in its frame

  double margin(const InstrumentOptions& options) const noexcept {
    return own_margin > 0.0 ? own_margin : options.margin;
  }
};

/// A body beside a mesh, and the pair's memory from cycle to cycle. Symbols in parentheses are
/// those of docs/joint-space-step.md.
struct PairMemory {
  std::size_t body;
  std::size_t mesh;
  NearSet triangles;
  double displacement = 0.0;  // rho of the last trial; predicts the next [length]
  double padding = 0.0;       // added to the needed radius of a search for triangles [length]
  /// The clearance that the last cycle certified (G). In a cycle, from PairWatch::open on, the
  /// certified clearance of this cycle (F), unless remember_clearances() lowers it. [length]
  double certified = -std::numeric_limits<double>::infinity();
  bool may_have_crossed = false;  // the body's side is unknown, as a dropped pair's
  // The present cycle.
  double moved = 0.0;               // see PairWatch::moved [length]
  double full_demand = 0.0;         // the clearance to certify if not degraded (F*) [length]
  double row_margin = 0.0;          // the clearance that rows demand [length]
  double clearance_fraction = 1.0;  // the fraction of the full demand to certify
  bool is_dropped = false;          // nothing is certified for the pair in this cycle
  bool is_settled = false;          // no joint moves the body, and its proof is complete
};

}  // namespace keepout
