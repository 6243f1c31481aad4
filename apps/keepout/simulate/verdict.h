// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulate/simulation.h"

namespace keepout::app {

/// What came out, in words for a reader who knows nothing of us.

/// What was simulated.
std::string subject(const Simulation& simulation, const std::vector<RunSummary>& summaries);

/// The one sentence at the top: which rules kept the tool out, and which did not.
std::string headline(const Simulation& simulation, const std::vector<RunSummary>& summaries);

/// The sentences below it: how deep, how often, out of how many.
std::string account(const Simulation& simulation, const std::vector<RunSummary>& summaries);

/// How long half of the steps took under each rule; empty where none was timed.
std::string step_times(const Simulation& simulation, const std::vector<RunSummary>& summaries);

/// One run in a few words, for the caption of its picture.
std::string outcome_of(const RunSummary& summary, SurfaceKind surface);

/// Whether a tip at this distance from the surface touches it: the check tells no less apart. [mm]
bool touches(double clearance);

/// The name of a run as a reader sees it.
std::string display_name(const Run& run);

/// One line on what the rule does; empty where the run says nothing.
std::string explanation(const Run& run);

}  // namespace keepout::app
