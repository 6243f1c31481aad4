// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulate/audit.h"
#include "simulate/simulated_tool.h"

namespace keepout::app {

/// The rule name of the unguarded run, which comes first.
inline constexpr const char* no_rule = "none";

/// Returns the record and the table of the runs of a tip: see docs/records.md. Its benchmark and
/// comparison are null. Precondition: there are strokes.
SimulationResult tip_result(const SimulateOptions& options, const Audit& audit,
                            const std::vector<FollowedStroke>& strokes,
                            const std::vector<RunTally>& runs);

}  // namespace keepout::app
