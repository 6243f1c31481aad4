// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

// Of the rules that prove each motion, in units of their tolerance tau. Solvers and the rounding of
// positions leave errors far below one tau. Each step of the ladder is one: what a free motion may
// lose, what a motion along a plane may lose on top, and where the margin counts as lost. Planes
// aim at the full margin, so that whatever was lost comes back.
inline constexpr double demand_below = 1.0;
inline constexpr double floor_below = 2.0;
inline constexpr double lost_below = 2.75;
inline constexpr double touching_within = 4.0;
inline constexpr double needed_margin = 8.0;
inline constexpr double region_beyond = 8.0;

inline constexpr double contact_slack = 1.0 / 8.0;  // of a contact: small beside demand_below

// A cycle's planes are few; under the tip of a cone of 400 faces some hundred; more are a loop that
// does not end.
inline constexpr std::size_t most_planes = 192;

}  // namespace keepout
