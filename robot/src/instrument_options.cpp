// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument_options.h"

#include <algorithm>

#include "cycle_memory.h"
#include "keepout/error.h"

namespace keepout {

void CycleMemory::require_usable(const InstrumentOptions& o) const {
  require_in_range(instrument_options, o);
  double margin = o.margin;  // the least
  for (const MeshMemory& mesh : bodies.meshes) {
    InstrumentOptions beside = o;
    beside.margin = mesh.margin(o);
    require_in_range(instrument_options, beside);
    margin = std::min(margin, beside.margin);
  }
  if (!(o.band < margin)) throw Error("the band must be below the margin of each mesh");
  if (is_lost_in_rounding(o)) {
    throw Error(
        "the margin, its band or a guide's band is lost in the rounding of an instrument and a "
        "mesh of this size: each must be well above 1e-11 of both");
  }
}

}  // namespace keepout
