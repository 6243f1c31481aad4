// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

/// Sixteen cylinders, coordinate by coordinate: around the triangles of a tree where they make up a
/// sheet, which a box that is not along it holds badly.
struct alignas(64) CylinderBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;

  float middle[3][lanes];    // [axis][lane] [length]
  float axis[3][lanes];      // of unit length, but for its rounding
  float half_height[lanes];  // along the axis, to either side of the middle [length]
  float radius[lanes];       // [length]
};

}  // namespace keepout
