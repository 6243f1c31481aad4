// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fuzz/harness.h"
#include "keepout/geometry/pose.h"
#include "keepout/robot/instrument.h"
#include "keepout/robot/instrument_options.h"

namespace keepout::fuzz {

/// Returns a pose in a cube around the origin. `width`: half of the edge of the cube. [length]
Pose any_pose(double width, Source& source);

/// Returns an instrument with 1 to 7 joints and 1 to 4 bodies. Throws Error.
Instrument any_instrument(Source& source);

/// Returns options, which a constraint may refuse.
InstrumentOptions any_instrument_options(Source& source);

}  // namespace keepout::fuzz
