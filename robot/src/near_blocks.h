// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Sixteen triangles in single precision, relative to a nearby origin, so that one instruction
/// examines many.
struct alignas(64) NearBlock {
  static constexpr std::size_t lanes = 16;

  float corner[3][3][lanes];  // [corner][axis][lane], relative to the origin [length]

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
  /// `size`: the largest coordinate of the blocks, relative to the same origin. [length]
  NearScreen(const Vec3& from, const Vec3& to, double distance, double size) noexcept;

  float from[3];
  float along[3];
  float inverse2;   // of |along|^2; 0 for a point
  float distance2;  // the square of the distance, enlarged by all rounding [length^2]
};

/// Returns a bit for each lane of a block: set if the triangle may be within the distance of the
/// segment. For other triangles, a plane across the shortest line from the segment to the middle of
/// the triangle proves that they are farther away. Bits of unused lanes are meaningless. The result
/// is the same on every processor.
std::uint32_t may_be_near(const NearBlock& block, const NearScreen& screen) noexcept;

}  // namespace keepout
