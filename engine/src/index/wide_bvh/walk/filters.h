// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "../tree.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The tip as the sum of two floats, so that what is near it keeps its digits when it is looked at
/// in float.
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

/// What is known of sixteen things while the tip stays where it is: unit vectors, and how far the
/// margin is kept along each. That the plane between thing and tip along a vector is valid is
/// checked by what holds the thing, however the vector was come by.
struct ProofBlock {
  static constexpr std::size_t lanes = 16;

  alignas(64) float n[3][lanes];   // [axis][lane]
  alignas(64) float clear[lanes];  // of the margin at the tip, less rounding [length]
};

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
