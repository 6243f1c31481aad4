// SPDX-License-Identifier: BSD-3-Clause
#include "page/packed_mesh.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace keepout::app {
namespace {

/// Returns true if the number is a float. Precondition: in the range of floats, as all coordinates
/// of a mesh are.
bool is_float(double number) { return static_cast<double>(static_cast<float>(number)) == number; }

/// Appends the bytes of a number, the lowest first, on every machine.
template <class Bits>
void append(std::vector<std::uint8_t>& bytes, Bits bits) {
  for (unsigned shift = 0; shift < 8 * sizeof bits; shift += 8) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

std::vector<std::uint32_t> corner_codes(std::span<const Corners> triangles) {
  std::vector<std::uint32_t> codes;
  codes.reserve(3 * triangles.size());
  std::uint32_t next = 0;
  for (const Corners& corners : triangles) {
    for (const VertexId corner : corners) {
      codes.push_back(next - corner);
      if (corner == next) ++next;
    }
  }
  return codes;
}

}  // namespace

PackedMesh packed(std::span<const Vec3> vertices, std::span<const Corners> triangles) {
  const bool floats = std::ranges::all_of(vertices, [](const Vec3& v) {
    return is_float(v.x()) && is_float(v.y()) && is_float(v.z());
  });
  PackedMesh result{.coordinates = floats ? "float32" : "float64", .bytes = {}};
  result.bytes.reserve(3 * (floats ? sizeof(float) : sizeof(double)) * vertices.size() +
                       3 * sizeof(std::uint32_t) * triangles.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const Vec3& vertex : vertices) {
      if (floats) {
        append(result.bytes, std::bit_cast<std::uint32_t>(static_cast<float>(vertex[axis])));
      } else {
        append(result.bytes, std::bit_cast<std::uint64_t>(vertex[axis]));
      }
    }
  }
  const std::vector<std::uint32_t> codes = corner_codes(triangles);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    for (const std::uint32_t code : codes) {
      result.bytes.push_back(static_cast<std::uint8_t>(code >> shift));
    }
  }
  return result;
}

}  // namespace keepout::app
