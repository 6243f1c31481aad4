// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "bench/benchmark.h"
#include "bench/pipeline.h"
#include "bench/reference.h"

namespace keepout::app {

/// First asks the pipeline for the motions, in order and for so many seconds (or up to four times
/// as many, to come to 1000 steps), holds each step to the reference and counts what went into it;
/// then, if all were right, times the same steps.
///
/// Steps must be those of the reference bit for bit if the solver is the same, `accuracy` being 0;
/// else within `accuracy` of the length of the motion. A solver may give up, but not be wrong.
/// Under a rule that proves each motion, another solver's may be worse, of which the row tells.
///
/// Fills the row from its queries on.
void measure(const Pipeline& pipeline, std::span<const Motion> motions, Reference& reference,
             double accuracy, double seconds, BenchmarkRow& row);

}  // namespace keepout::app
