// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "float_motion.h"
#include "keepout/index/leaf_block.h"

namespace keepout {

/// What is known of the sixteen triangles of a leaf while the tip stays where it is: unit vectors,
/// and how far the margin is kept along each. That the plane between triangle and tip along a
/// vector is valid is checked by its corners, however the vector was come by.
struct LeafScreen {
  struct Normals {
    alignas(64) float n[3][LeafBlock::lanes];   // [axis][lane]
    alignas(64) float clear[LeafBlock::lanes];  // of the margin at the tip, less rounding [length]
  };
  Normals at_tip;  // from the closest point to the tip
  Normals last;    // the last ones that were found better for some motion
};

/// Looks at a leaf for the first time from this tip.
void look(const LeafBlock& leaf, const FloatTip& tip, const FloatReach& reach,
          LeafScreen& screen) noexcept;

/// Triangles that a motion is not sure to keep clear of: a bit for each, and when it may meet them,
/// never late: a share of the motion, or minus infinity for those that may be too close already.
struct Suspects {
  alignas(64) float time[LeafBlock::lanes];
  std::uint32_t mask;
};

void suspect(const LeafScreen& screen, const float* motion, Suspects& suspects) noexcept;

/// The same, after some cutting-plane steps for those that are left over: dearer, and sharper.
void suspect_sharply(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                     const FloatReach& reach, LeafScreen& screen, Suspects& suspects) noexcept;

}  // namespace keepout
