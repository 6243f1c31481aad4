// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace keepout {

/// What gave way in a cycle, as all that is asked for could not be had: nothing of it gets worse.
enum class Softening : std::uint8_t {
  none,    // nothing but the task, which is the first to
  guides,  // those that were left are not led back: see GuideState::gave_way
  bodies   // nor are bodies that are too close led off as fast as options.recovery says
};

/// How a guide fared in a cycle.
struct GuideState {
  /// How far out of the region as the cycle began; below 0 in it. [length, or all but rad]
  double excess = 0.0;
  bool holds = false;     // whether it holds the motion back
  bool gave_way = false;  // whether it does not lead back what is out, as others contradict
};

}  // namespace keepout
