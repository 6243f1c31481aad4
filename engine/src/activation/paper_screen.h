// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/activation/activation.h"
#include "keepout/index/wide_bvh.h"
#include "leaf_edges.h"

namespace keepout {

/// The surroundings of a tip, as floats look at them.
struct PaperQuery {
  float high[3];  // the tip is high + low, so that what is near it keeps its digits
  float low[3];
  float radius;    // of the ball, rounded up ...
  float inside;    // ... and down
  float inside2;   // its square, rounded down ...
  float outside2;  // ... and up
  float touch2;    // square of the distance within which a point is on the surface, rounded up
  float rounding;  // how deep below a face is not below it [length]
  float error;     // of a corner, but for the rounding of floats about the tip [length]

  // Planes that are idle: no motion in the ball over `middle` violates them. See idle_ball.
  float middle[3];
  float middle_length;  // rounded up
  float idle_height;    // of `middle` above a face [length]; infinite: none is idle
  float idle;           // distance of a point that a plane faces the tip from
  float idle2;          // its square
};

/// The motions that are nearer to half the aim than half its length, and a little more: every
/// projection of the aim on planes that allow standing still is one (Thales).
Ball idle_ball(const Vec3& aim) noexcept;

/// `error`: of each coordinate in leaves.
PaperQuery paper_query(const Surroundings& around, double error, NeededPlanes needed) noexcept;

/// The boxes that touch the ball: a bit for each used one. Never one too few.
std::uint32_t boxes_near(const NodeBlock& boxes, const PaperQuery& query) noexcept;

/// Triangles that a first look left, close together; coordinates are relative to the tip. There is
/// room for a whole vector beyond the last one.
struct PaperRest {
  static constexpr std::size_t most = 512;
  static constexpr std::size_t room = most + LeafBlock::lanes;

  std::size_t settled = 0;  // others: surely in the ball, and surely without a plane that is needed
  std::size_t size = 0;
  alignas(64) float corner[3][3][room];  // [corner][axis][lane]
  float reach[room];                     // no corner and no apex is farther from the tip
  std::uint32_t corners[room];           // LeafEdges::corners, and what follows
  std::uint32_t roles[room];             // LeafEdges::roles
  std::uint32_t source[room];            // LeafBlock::source
  std::uint32_t place[room];             // the leaf, times its lanes, and the lane

  static constexpr std::uint32_t face_is_idle = std::uint32_t{1} << 26;  // its plane is
  static constexpr std::uint32_t in_front = std::uint32_t{1} << 27;      // the tip surely is
  static constexpr std::uint32_t behind = std::uint32_t{1} << 28;        // it surely is not
  static constexpr std::uint32_t planeless = std::uint32_t{1} << 29;     // surely, as if settled
};

/// A first look at leaves, until they end or no more triangles fit. How many it looked at. `edges`
/// are those of the tree's leaves.
std::size_t look(const WideBvh& tree, std::span<const LeafEdges> edges, const PaperQuery& query,
                 std::span<const std::uint32_t> leaves, PaperRest& rest) noexcept;

/// What floats are sure of.
struct PaperAnswers {
  std::size_t in = 0;      // how many triangles are in the ball, but for open ones
  std::size_t planes = 0;  // how many of those have a plane that is needed
  std::size_t opens = 0;   // of how many floats cannot tell

  std::uint32_t triangle[PaperRest::room];  // with a plane
  /// The corners on which its closest point lies, as in LeafEdges::corners, and whether the plane
  /// faces the tip (condition 2) or is the face's (3).
  std::uint32_t origin[PaperRest::room];
  static constexpr std::uint32_t faces_tip = 1u << LeafEdges::corner_bits;

  std::uint32_t open[PaperRest::room];  // triangles
};

/// A closer look at what is left, which fills `answers` anew, the settled triangles among them.
void screen(std::span<const LeafEdges> edges, const PaperQuery& query, const PaperRest& rest,
            PaperAnswers& answers) noexcept;

}  // namespace keepout
