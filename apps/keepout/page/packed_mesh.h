// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// A mesh in a page: without loss, in bytes that compress well.
struct PackedMesh {
  std::string_view coordinates;  // "float32" if all coordinates are floats, else "float64"
  /// First all x, all y and all z of the vertices, each number with its lowest byte first. Then one
  /// code for each corner: the lowest vertex number not used by earlier corners, minus the corner's
  /// own number (modulo 2^32). The codes are small, because a welded mesh numbers its vertices by
  /// their first use. They are stored as all lowest bytes, then all second, all third and all
  /// highest bytes.
  std::vector<std::uint8_t> bytes;
};

PackedMesh packed(std::span<const Vec3> vertices, std::span<const Corners> triangles);

}  // namespace keepout::app
