// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "keepout/buffer.h"
#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/side_memory.h"
#include "near_set.h"
#include "relative_motion.h"
#include "row.h"

namespace keepout {

/// A mesh, its pose, and what the cycles remember of it.
struct MeshMemory {
  std::unique_ptr<Neighborhood> neighborhood;
  double own_margin;  // 0: the mesh has the margin of the options [length]
  bool is_watertight;
  RelativeMotion motion;                           // of the instrument, in the mesh's frame
  Pose pose = {};                                  // at the start of the next cycle
  Twist velocity = {};                             // [length/s], [rad/s]
  bool is_misplaced = false;                       // its last pose was rejected
  SideMemory<Instrument::most_points> sides = {};  // of all points, in its frame

  double margin(const InstrumentOptions& options) const noexcept {
    return own_margin > 0.0 ? own_margin : options.margin;
  }
};

/// A body beside a mesh, and what the cycles remember of the pair.
struct PairMemory {
  std::size_t body;
  std::size_t mesh;
  NearSet triangles;
  double displacement = 0.0;  // the largest of its points on the last trial; predicts the next
  double padding = 0.0;       // of the search for triangles, beyond what is needed [length]
  /// The clearance that the last cycle certified. In a cycle, from BodyWatch::open on, the one that
  /// this cycle certifies unless close() lowers it. [length]
  double certified = 0.0;
  bool may_have_crossed = false;  // no clearance was certified: the body's side must be found
  // Of this cycle.
  double full_clearance = 0.0;      // to be certified while it is not degraded [length]
  double row_margin = 0.0;          // the margin that rows demand, beyond the radius [length]
  double clearance_fraction = 1.0;  // of the clearance that is to be certified
  bool is_dropped = false;          // nothing is certified: no motion could be proved for the pair
  bool is_settled = false;          // no joint moves the body, and its proof is complete
};

/// The pairs of bodies and meshes. Made once for all cycles of an instrument.
struct PairMemories {
  std::vector<MeshMemory> meshes;
  std::vector<PairMemory> pairs;                   // all bodies with the first mesh, and so on
  Buffer<DegradedClearance> degraded{most_pairs};  // of the last cycle
};

}  // namespace keepout
