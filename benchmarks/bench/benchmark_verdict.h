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

/// Whether rows that differ in the index alone led to the same steps, as far as they made the same;
/// and which rows have no such other. Empty where there are none.
std::string same_steps(const Benchmark& benchmark);

/// A pair of an index and a solver that is set against another wherever both were timed.
struct Pair {
  const char* index;
  const char* solver;
};
inline constexpr Pair our_pair = {"wide_bvh", "active_set"};
inline constexpr Pair peer_pair = {"fcl_obbrss", "nlopt_slsqp"};

}  // namespace keepout::app
