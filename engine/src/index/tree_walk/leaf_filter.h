// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "float_motion.h"
#include "keepout/index/triangle_blocks.h"

namespace keepout {

/// What is known of the sixteen triangles of a leaf.
struct LeafFilter {
  ProofBlock at_tip;  // from the closest points to the tip
  ProofBlock last;    // the last ones that were found better for some motion
};

/// Looks at a leaf for the first time from this tip.
void look(const LeafBlock& leaf, const FloatTip& tip, const FloatReach& reach,
          LeafFilter& filter) noexcept;

/// Triangles that a motion is not sure to keep clear of: a bit for each, and when it may meet them,
/// never late: a share of the motion, or minus infinity for those that may be too close already.
struct Suspects {
  alignas(64) float time[LeafBlock::lanes];
  std::uint32_t mask;
};

void find_suspects(const LeafFilter& filter, const float* motion, Suspects& suspects) noexcept;

/// The same, after some cutting-plane steps for those that are left over: dearer, and sharper.
/// Those that come later than `latest`, a share of the motion, may be left as they are.
void refine_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                     const FloatReach& reach, float latest, LeafFilter& filter,
                     Suspects& suspects) noexcept;

/// A Newton step towards the times when the suspects are met: makes them later. As far as `latest`.
void delay_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                    const FloatReach& reach, float latest, Suspects& suspects) noexcept;

}  // namespace keepout
