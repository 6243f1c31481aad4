// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "float_motion.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {

/// When a motion may first come within the margin of what is in each of sixteen boxes: a share of
/// the motion, never late; 0 where it begins there, beyond 1 where it never does.
struct BoxEntries {
  alignas(64) float time[NodeBlock::lanes];
  std::uint32_t reached;  // a bit for each box that is reached
};

void enter_boxes(const NodeBlock& boxes, const FloatTip& tip, const float* motion,
                 const FloatReach& reach, BoxEntries& entries) noexcept;

/// Looks closer at the boxes that are reached: by the directions from their cylinders to the places
/// of the motion that are nearest to them.
void enter_cylinders(const CylinderBlock& cylinders, const FloatTip& tip, const float* motion,
                     const FloatReach& reach, BoxEntries& entries) noexcept;

/// The boxes within `radius` of the tip: a bit for each. Never one too few.
std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept;

/// How far the nearest of the boxes is from the centre, or a little less. [length]
float distance_to_boxes(const NodeBlock& boxes, const FloatTip& center) noexcept;

}  // namespace keepout
