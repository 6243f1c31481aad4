// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "keepout/geometry/vec3.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {

/// A motion from the tip, to be looked at in float: the tip as the sum of two floats, so that what
/// is near it keeps its digits.
struct FloatTip {
  float high[3];
  float low[3];
};

FloatTip float_tip(const Vec3& tip) noexcept;

/// How near is near. All are rounded up.
struct FloatReach {
  float margin;    // to keep from the motion [length]
  float relative;  // what rounding adds: so much of |v - tip| of the farthest corner v ...
  float slack;     // ... and this [length]
  float boxes;     // margin and rounding, for boxes [length]
};

/// `error`: of the coordinates in leaves. `longest`: no motion that is looked at is longer.
FloatReach float_reach(double margin, double longest, const Vec3& tip, double error) noexcept;

/// When a motion may first come within the margin of each of sixteen boxes: a share of the motion,
/// never late; 0 where it begins there, beyond 1 where it never does.
struct BoxEntries {
  alignas(64) float time[NodeBlock::lanes];
  std::uint32_t reached;  // a bit for each box that is reached
};

/// `rounded`: looks closer, which is worth it where a motion passes many boxes by. Then the margin
/// rounds the boxes; else they keep sharp corners.
void enter_boxes(const NodeBlock& boxes, const FloatTip& tip, const float* motion,
                 const FloatReach& reach, bool rounded, BoxEntries& entries) noexcept;

/// The boxes within `radius` of the tip: a bit for each. Never one too few.
std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept;

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
