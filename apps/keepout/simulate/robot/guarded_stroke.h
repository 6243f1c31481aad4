// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "simulate/robot/strokes.h"
#include "verify/campaign.h"

namespace keepout::app {

/// What keeps an instrument out of the mesh.
enum class Mode : std::uint8_t { certified, linearised, tip_only, none };
inline constexpr std::array modes{Mode::certified, Mode::linearised, Mode::tip_only, Mode::none};
/// "certified", "linearised", "tip only", "none".
std::string_view name(Mode mode) noexcept;

/// Those of the PSM, in its order.
inline constexpr std::array<std::string_view, 3> body_names{"shaft", "wrist", "jaw"};

/// What became of a body.
struct BodyTally {
  std::uint64_t below = 0;    // cycles closer than the certified distance, margin - band
  std::uint64_t in_mesh = 0;  // of them, those in which the mesh reached into it
  double deepest = 0.0;       // of those: how far, up to the body's radius [mm]
};

/// What came out of all strokes on a mesh, at one speed, in one mode.
struct ModeTally {
  std::string mesh = {};
  double speed = 1.0;
  Mode mode = Mode::certified;
  std::uint64_t cycles = 0;
  std::uint64_t refused = 0;        // cycles without a motion that may be carried out
  std::uint64_t limits_broken = 0;  // of the joints
  BodyTally any = {};               // of the bodies together
  std::array<BodyTally, 3> bodies = {};
};

/// One cycle, as it ended.
struct GuardedCycle {
  std::array<Vec3, 3> places;        // ends of the bodies, from shaft to tip [mm]
  std::array<double, 3> clearances;  // least of each at its poses; infinite beyond the margin [mm]

  double least() const { return *std::ranges::min_element(clearances); }
};

/// Follows the hand of a stroke in closed loop, from its start, in the mode of the tally, and
/// judges each cycle at five poses or six with the oracle's own kinematics and distances. `random`
/// chooses the poses between.
std::vector<GuardedCycle> follow(const RobotStroke& stroke, RobotScene& on, Random random,
                                 ModeTally& tally);

}  // namespace keepout::app
