// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Sixteen triangles in floats, from an origin close by, so that one instruction looks at many.
struct alignas(64) NearBlock {
  static constexpr std::size_t lanes = 16;

  float corner[3][3][lanes];  // [corner][axis][lane], from the origin [length]

  /// Puts a triangle into a lane.
  void set(std::size_t lane, const Triangle& triangle, const Vec3& origin) noexcept {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        corner[c][axis][lane] = static_cast<float>(triangle[c][axis] - origin[axis]);
      }
    }
  }
};

/// A segment, and how near to it is near, as floats see it.
struct NearScreen {
  /// `size`: no coordinate of the blocks is larger, from the same origin. [length]
  NearScreen(const Vec3& from, const Vec3& to, double distance, double size) noexcept;

  float from[3];
  float along[3];
  float inverse2;   // of |along|^2; 0 for a point
  float distance2;  // of the distance and all that rounding may have taken [length^2]
};

/// Which triangles of a block may be as near as that: a bit for each lane. The others are surely
/// not: the plane across the way from the segment to their middle proves it. Of unused lanes the
/// bits mean nothing. The same on every processor.
std::uint32_t may_be_near(const NearBlock& block, const NearScreen& screen) noexcept;

}  // namespace keepout
