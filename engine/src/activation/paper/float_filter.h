// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "leaf_edges.h"

namespace keepout {

/// Which planes the paper's rule is to find, as floats see it. What is near the tip keeps its
/// digits: the tip is high + low.
struct FilterQuery {
  float high[3];
  float low[3];
  float radius;    // of the ball, rounded up ... [length]
  float inside;    // ... and down
  float rounding;  // nearer than that is on the surface, and no deeper below is not below [length]
  float error;     // of a corner, but for the rounding of floats about the tip [length]

  // Planes are idle if no motion in idle_ball violates them; infinite if all are wanted.
  float middle[3];    // of that ball
  float idle_height;  // of the middle above a face whose plane is idle [length]
  float idle;         // distance of a point that an idle plane faces the tip from [length]
};

/// The motions that are nearer to half the target than half its length, and a little more: every
/// projection of the target on planes that allow standing still is one (Thales).
Ball idle_ball(const Vec3& target) noexcept;

/// What becomes of planes that no motion in idle_ball violates.
enum class IdlePlanes : std::uint8_t { found, left_out };

/// Of the triangles in the ball. `frame`: of the leaves.
FilterQuery filter_query(const RuleInput& input, const Ball& ball, const LeafFrame& frame,
                         IdlePlanes idle_planes) noexcept;

/// The triangles that floats are not done with. There is room for a whole vector beyond the last.
struct Unfinished {
  static constexpr std::size_t most = 512;
  static constexpr std::size_t room = most + LeafBlock::lanes;

  std::size_t in = 0;         // how many, these or others, are surely in the ball
  std::size_t size = 0;       // how many these are
  std::uint32_t which[room];  // the number of the leaf, times its lanes, and the lane

  /// The plane that a triangle in the ball has, and then above the two bits which of the `places`
  /// its closest point lies on. Neither bit where floats cannot tell.
  std::uint32_t plane[room];
  static constexpr std::uint32_t faces_tip = 1;  // condition 2
  static constexpr std::uint32_t of_face = 2;    // condition 3
  static constexpr int plane_bits = 2;

  // Between the first look and the second; coordinates are relative to the tip.
  alignas(64) float corner[3][3][room];  // [corner][axis][triangle]
  float reach[room];                     // no corner and no apex is farther from the tip
  std::uint32_t roles[room];             // LeafEdges::roles

  // In `plane`, meanwhile: the face surely has none that is wanted; the tip is in front of it.
  static constexpr std::uint32_t faceless = 1;
  static constexpr std::uint32_t in_front = 2;
};

/// Looks at leaves, the first of those that are `listed`, until they end or no more triangles fit;
/// fills `unfinished` anew, and returns how many it looked at. `edges` are those of `leaves`.
std::size_t filter(std::span<const LeafBlock> leaves, std::span<const LeafEdges> edges,
                   std::span<const std::uint32_t> listed, const FilterQuery& query,
                   Unfinished& unfinished) noexcept;

}  // namespace keepout
