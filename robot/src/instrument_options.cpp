// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument_options.h"

#include <algorithm>

#include "cycle_memory.h"
#include "keepout/error.h"

namespace keepout {

void CycleMemory::require_usable(const InstrumentOptions& o) const {
  const auto within = [](double x, double low) { return x >= low && x <= longest_length; };
  double margin = o.margin;  // the least
  bool all_within = within(o.margin, shortest_length);
  for (const MeshMemory& mesh : bodies.meshes) {
    margin = std::min(margin, mesh.margin(o));
    all_within = all_within && within(mesh.margin(o), shortest_length);
  }
  if (!all_within || !(o.band > 0.0) || !(o.band < margin)) {
    throw Error(
        "the margins must be above zero, and lengths, and the band above zero and below each of "
        "them");
  }
  if (!within(o.slowing_within, 0.0) ||
      !(o.slowing_time > 0.0 && o.slowing_time < largest_number)) {
    throw Error("slowing_within must not be below zero, and slowing_time must be above it");
  }
  if (!within(o.recovery, 0.0) || !within(o.damping, 0.0) || !within(o.orientation_weight, 0.0) ||
      !(o.period > 0.0 && o.period < largest_number) || o.refinements < 0) {
    throw Error(
        "recovery, damping, orientation weight and refinements must not be below zero, and the "
        "period must be above it");
  }
  if (is_lost_in_rounding(o)) {
    throw Error(
        "the margin, its band or a guide's band is lost in the rounding of an instrument and a "
        "mesh of this size: each must be well above 1e-11 of both");
  }
}

}  // namespace keepout
