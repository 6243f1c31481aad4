// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// A mesh as a page carries it: every bit of it, in bytes that compress well.
struct PackedMesh {
  std::string_view coordinates;  // "float32" where that is all of each of them, else "float64"
  /// All x, then all y, then all z of the vertices, each number with its lowest byte first; then
  /// the corners of the triangles, each as the number of the first vertex that no corner before has
  /// named, less its own (modulo 2^32): small, since a welded mesh numbers its vertices by their
  /// first use. All lowest bytes of these, then all second, all third, all highest.
  std::vector<std::uint8_t> bytes;
};

PackedMesh packed(std::span<const Vec3> vertices, std::span<const Corners> triangles);

}  // namespace keepout::app
