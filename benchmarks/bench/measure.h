// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "bench/benchmark.h"
#include "compare/reference.h"
#include "shared/stop_signal.h"

namespace keepout::app {

/// Asks the constraint, which is put together as any user has it but takes tips as they are, for
/// the motions, in order and for so many seconds (or up to four times as many, to come to 1000
/// steps), stage by stage; then for the same steps as a whole; then the index for all triangles
/// where the rule looks for them at first. Each answer of each time is held to the reference
/// afterwards, and unless all are right no time is taken down.
///
/// Steps must be those of the reference bit for bit if the accuracy of the solver is 0; else within
/// so much of the length of the motion. A solver may give up, but not be wrong. Under a rule that
/// proves each motion, another solver's may be worse, of which the row tells. Triangles and their
/// closest points must be those of the reference bit for bit.
///
/// Fills the row from its queries on. Of no use when it was stopped meanwhile.
void measure(MotionConstraint& constraint, double accuracy, std::span<const Motion> motions,
             Reference& reference, double seconds, const StopSignal& stop, BenchmarkRow& row);

}  // namespace keepout::app
