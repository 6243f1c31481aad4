// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "../tree.h"
#include "keepout/geometry/shapes.h"
#include "keepout/index/motion_traversal.h"

namespace keepout {

/// The tip as the sum of two floats, so that positions near it keep their digits in single
/// precision.
struct FloatTip {
  float high[3];
  float low[3];
};

/// Splits a tip, given relative to the origin of the tree's frame. [length]
inline FloatTip float_tip(const Vec3& tip) noexcept {
  FloatTip split;
  for (int axis = 0; axis < 3; ++axis) {
    split.high[axis] = static_cast<float>(tip[axis]);
    split.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(split.high[axis]));
  }
  return split;
}

/// The level of a traversal in single precision, and the rounding to add to it. All are rounded up.
struct FloatLevels {
  float level;  // distance within which a motion comes near: MotionTraversal::Start::level [length]
  float relative;   // rounding, as a fraction of |v - tip| of the farthest corner v ...
  float slack;      // ... plus this [length]
  float box_level;  // level and rounding, for boxes [length]
};

// The excess of a traversal's level in single precision, as fractions of the level and of the
// longest motion. Both exceed the rounding of the lanes, which is below 1e-6 of these lengths. The
// rest is needed elsewhere: known_distance() of the certified rule needs more than 5e-7 of the
// level, and MotionTraversal::traversal() more than `alike` of the motion.
constexpr double slack_of_level = 2e-6;
constexpr double slack_of_motion = 3e-6;
static_assert(slack_of_level >= 1e-6 + 5e-7 && slack_of_motion >= 1e-6 + MotionTraversal::alike);

/// Returns the levels of a traversal. `longest`: no motion is longer. `tip`: relative to the origin
/// of the tree's frame. `error`: of the coordinates in leaves. [length]
inline FloatLevels float_levels(double level, double longest, const Vec3& tip,
                                double error) noexcept {
  // The part of the tip beyond its two floats, and the error of the leaf's coordinates.
  const double fixed = 1e-13 * tip.lpNorm<1>() + 4.0 * error;
  const double slack = slack_of_level * level + slack_of_motion * longest + fixed;
  const double box_level = level * (1.0 + 2e-6) + 4e-6 * longest + fixed;
  constexpr double up = 1.0 + 1e-6;
  return {static_cast<float>(level * up), 1.5e-6f, static_cast<float>(slack * up),
          static_cast<float>(box_level * up)};
}

/// Proofs for sixteen triangles (or boxes) while the tip does not move: unit vectors, and the
/// clearance that each proves. Any unit vector is valid, because its clearance is computed from the
/// triangle itself.
struct ProofBlock {
  static constexpr std::size_t lanes = 16;

  alignas(64) float n[3][lanes];  // [axis][lane]
  /// The proven distance of the tip, minus level and rounding. [length]
  alignas(64) float clear[lanes];
};

/// The time at which a motion may first come within the level of the triangles in each of sixteen
/// boxes. It is a fraction of the motion, never late, and 0 if the motion begins there. It has no
/// meaning for boxes that are not reached.
struct BoxEntries {
  alignas(64) float time[NodeBlock::lanes];
  std::uint32_t reached;  // a bit for each box that is reached
};

/// Fills `entries` with the boxes of a node that a motion may reach. `motion`: three coordinates.
/// [length]
void enter_boxes(const NodeBlock& boxes, const FloatTip& tip, const float* motion,
                 const FloatLevels& levels, BoxEntries& entries) noexcept;

/// Improves the entries of the boxes that are reached, with the directions from their cylinders to
/// the nearest points of the motion. Then it does so with the points where the motion enters so
/// far.
void enter_cylinders(const CylinderBlock& cylinders, const FloatTip& tip, const float* motion,
                     const FloatLevels& levels, BoxEntries& entries) noexcept;

/// Returns the boxes within `radius` of the center, one bit each. Some others may be included.
std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept;

/// Returns the distance of the nearest box from the center, or a little less. [length]
float distance_to_boxes(const NodeBlock& boxes, const FloatTip& center) noexcept;

/// Proofs for the sixteen triangles of a leaf.
struct LeafFilter {
  ProofBlock at_tip;  // along the shortest segments to the tip
  ProofBlock last;    // of the last step of sharpen_suspects(), if has_last
  bool has_last;      // false until the first call of sharpen_suspects()
};

/// Fills the filter of a leaf for this tip. Lanes without a triangle are always clear.
void fill_filter(const LeafBlock& leaf, const FloatTip& tip, const FloatLevels& levels,
                 LeafFilter& filter) noexcept;

/// Triangles of a leaf that a motion is not proved to stay clear of in time, one bit each. `time`
/// is when the motion may meet them, never late: a fraction of the motion.
struct Suspects {
  alignas(64) float time[LeafBlock::lanes];
  std::uint32_t mask;
  std::uint32_t earliest;  // the suspect of least time; any number without suspects

  /// Removes a suspect.
  void remove(std::uint32_t lane) noexcept;
};

/// Finds the suspects among the triangles of a leaf that the motion may meet up to the time
/// `latest`. Those at time 0 or before are not in `suspects`: returns them, one bit each, as the
/// tip may be too close to them already. `motion`: three coordinates. [length]
std::uint32_t find_suspects(const LeafFilter& filter, const float* motion, float latest,
                            Suspects& suspects) noexcept;

/// Searches for better proofs for the suspects: delays some, and removes those that the motion does
/// not meet up to the time `latest`. Makes `steps` Newton steps, each from a suspect's time so far.
/// A step may find a normal along which the motion moves away. Then the proofs before it cover the
/// beginning of the motion, and this one the rest. A step costs more than find_suspects.
void sharpen_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                      const FloatLevels& levels, float latest, int steps, LeafFilter& filter,
                      Suspects& suspects) noexcept;

}  // namespace keepout
