// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "contact_row.h"
#include "keepout/buffer.h"
#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/side_memory.h"
#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

/// A mesh, its pose, and what the cycles remember of it.
struct MeshMemory {
  std::unique_ptr<Neighborhood> near;
  double own_margin;  // 0: that of the options [length]
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
  NearSet near;
  double displacement = 0.0;     // the largest of its points on the last motion [length]
  double padding = 0.0;          // of the search for triangles, beyond what is needed [length]
  double certified = 0.0;        // the clearance that the last cycle certified [length]
  bool is_side_unknown = false;  // it was dropped, so the body may have crossed the surface
  // Of this cycle.
  double clearance = 0.0;   // to be certified while it is not degraded [length]
  double row_margin = 0.0;  // the margin that rows demand, beyond the radius [length]
  double fraction = 1.0;    // of the clearance that is to be certified
  bool is_dropped = false;  // nothing is certified: no motion could be proved for the pair
  bool is_settled = false;  // no joint moves the body, and its proof is complete
};

/// The pairs of bodies and meshes. Made once for all cycles of an instrument.
struct PairMemories {
  std::vector<MeshMemory> meshes;
  std::vector<PairMemory> pairs;                   // all bodies with the first mesh, and so on
  Buffer<DegradedClearance> degraded{most_pairs};  // of the last cycle
};

}  // namespace keepout
