// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "leaf_edges.h"

namespace keepout {

/// The query of the filter. Coordinates near the tip keep their digits, because the tip is high +
/// low.
struct FilterQuery {
  float high[3];
  float low[3];
  float radius;    // of the ball, rounded up [length]
  float inside;    // of the ball, rounded down [length]
  float rounding;  // points this near are on the surface, and this little below a face count as
                   // above [length]
  float error;     // of a corner, apart from the rounding of floats relative to the tip [length]

  // A plane is idle if no motion in idle_ball violates it. Both limits are infinite if all planes
  // are wanted.
  float middle[3];    // of that ball
  float idle_height;  // height of the middle above a face, beyond which its plane is idle [length]
  float idle;         // distance of a point from the tip, beyond which its plane is idle [length]
};

/// Returns the ball over the target, slightly enlarged. It contains every projection of the target
/// on planes that allow standing still (Thales).
Ball idle_ball(const Vec3& target) noexcept;

/// The treatment of planes that no motion in idle_ball violates.
enum class IdlePlanes : std::uint8_t { found, left_out };

/// Returns the query for the triangles in the ball. `frame`: of the leaves.
FilterQuery filter_query(const RuleInput& input, const Ball& ball, const LeafFrame& frame,
                         IdlePlanes idle_planes) noexcept;

/// The triangles that floats cannot settle. The arrays have capacity for one more vector.
struct Unfinished {
  static constexpr std::size_t most = 512;
  static constexpr std::size_t room = most + LeafBlock::lanes;

  std::size_t in = 0;         // triangles, of these or others, that are surely in the ball
  std::size_t size = 0;       // number of these triangles
  std::uint32_t which[room];  // number of the leaf, times its lanes, plus the lane

  /// The plane of a triangle in the ball in the two low bits, neither of them if floats are not
  /// sure. The place of its closest point (see `places`) is above these bits.
  std::uint32_t plane[room];
  static constexpr std::uint32_t faces_tip = 1;  // condition 2
  static constexpr std::uint32_t of_face = 2;    // condition 3
  static constexpr int plane_bits = 2;

  // Between the two passes; coordinates are relative to the tip.
  alignas(64) float corner[3][3][room];  // [corner][axis][triangle]
  float reach[room];                     // no corner and no apex is farther from the tip
  std::uint32_t roles[room];             // LeafEdges::roles

  // Bits of `plane` between the passes: the face surely has no wanted plane; the tip is in front of
  // it.
  static constexpr std::uint32_t faceless = 1;
  static constexpr std::uint32_t in_front = 2;
};

/// Filters the first of the `listed` leaves, until the list ends or `unfinished` is full. Fills
/// `unfinished` anew, and returns the number of leaves filtered. `edges`: of `leaves`.
std::size_t filter(std::span<const LeafBlock> leaves, std::span<const LeafEdges> edges,
                   std::span<const std::uint32_t> listed, const FilterQuery& query,
                   Unfinished& unfinished) noexcept;

}  // namespace keepout
