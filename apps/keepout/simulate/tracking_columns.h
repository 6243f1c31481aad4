// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "keepout/robot/instrument_options.h"
#include "shared/columns.h"
#include "simulate/tally.h"

namespace keepout::app {

/// The modes with --physics: the setpoint of the certified step, and the simulated robot that
/// follows it.
inline const std::vector<std::string> physical_mode_names{"setpoint", "measured"};

/// Returns the columns of the modes with --physics: also the margin and the speed in mm/s. For each
/// body: the smallest clearance, the largest tracking error, and the margin whose certified
/// clearance is that error. `modes`: the columns without physics.
Columns<RunTally> tracking_columns(Columns<RunTally> modes, std::span<const Body> bodies,
                                   const InstrumentOptions& options);

/// Returns the sentence of the headline on the measured instrument, after a space.
std::string sentence_on_tracking(std::span<const RunTally> runs, double band);

inline constexpr const char* tracking_meaning =
    R"(setpoint: that of a CrtkSession; measured: the simulated robot that follows it. close: cycles in
which a body was closer than its certified clearance; an independent judge examines five poses of
each. in mesh: of these, cycles in which a body reached into the mesh. least: the smallest clearance
in mm, - beyond the margin; error: the largest distance of a point of the body from its setpoint;
asks: the margin that this error asks for, error plus curvature allowance. refused: cycles in which
the setpoint stood still; limits: cycles that broke a joint limit, of position or velocity.
)";

}  // namespace keepout::app
