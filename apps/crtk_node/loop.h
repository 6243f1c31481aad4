// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "node.h"

namespace keepout::crtk {

/// The measurements of a loop.
struct LoopReport {
  double seconds = 0.0;      // that it ran
  std::uint64_t cycles = 0;  // that it ran
  std::uint64_t lost = 0;    // periods without a cycle
  /// The lost periods after a cycle that computed for longer than a period, or waited for a lock.
  std::uint64_t lost_here = 0;
  double longest = 0.0;         // the most processor time of a cycle [s]
  double resident_early = 0.0;  // memory after a tenth of the time, or at the end [MB]
  double resident = 0.0;        // memory at the end [MB]

  /// Returns the report as one line.
  std::string text() const;
};

/// Runs the cycles of a node, one each period, until `seconds` have passed or `stop` is true. A
/// cycle that starts late does not run twice: the periods that have passed are lost. `seconds`: 0
/// means forever.
LoopReport run_loop(Node& node, double period, double seconds, bool (*stop)());

}  // namespace keepout::crtk
