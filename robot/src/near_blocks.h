// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

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

/// The query of may_be_near: a segment and a distance in single precision, the distance enlarged by
/// all rounding.
struct NearScreen {
  /// `size`: no coordinate of the blocks is larger, from the same origin. [length]
  NearScreen(const Vec3& from, const Vec3& to, double distance, double size) noexcept;

  float from[3];
  float along[3];
  float inverse2;   // of |along|^2; 0 for a point
  float distance2;  // of the distance and all that rounding may have taken [length^2]
};

/// Returns a bit for each lane of a block: set if the triangle may be within the distance of the
/// segment. A plane across the shortest line from the segment to the middle of the triangle proves
/// that others are not. Bits of unused lanes are meaningless. The same on every processor.
std::uint32_t may_be_near(const NearBlock& block, const NearScreen& screen) noexcept;

}  // namespace keepout
