// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulate/audit.h"

namespace keepout::app {

/// How often and how long a simulated hand moves: one position each cycle.
struct HandSettings {
  std::uint64_t seed = 1;
  std::size_t strokes = 24;
  std::size_t cycles = 1000;  // of each stroke
};
inline constexpr double cycle_seconds = 0.001;

/// Where a surgeon's hand would have the tip, cycle by cycle, were there no fixture: down from free
/// space to below the surface, along underneath it, and back up, with a tremor. It does not feel
/// the fixture, so the same hand serves every rule.
///
/// Strokes go in where the surface faces outwards, as seen from the middle of the mesh, or, if that
/// is nowhere free (a flat sheet, a mesh that keeps the tool inside), at any free place. Throws
/// Error when there is none.
std::vector<std::vector<Vec3>> make_hand(Audit& audit, const HandSettings& settings);

}  // namespace keepout::app
