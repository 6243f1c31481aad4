// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/benchmark.h"

namespace keepout::app {

/// What the benchmark found, in words for a reader who knows nothing of us. Plain text, not yet
/// escaped. All of it follows from the rows; nothing presumes who is the faster.

/// The one sentence at the top: our pair of parts against its peer's where both made enough steps
/// under the same conditions, or else the fastest combination against the slowest.
std::string headline(const Benchmark& benchmark);

/// The sentences below it: where that holds, what it is at the other radii, what the names stand
/// for, what was left out, and whether the machine was busy with other things.
std::string account(const Benchmark& benchmark);

}  // namespace keepout::app
