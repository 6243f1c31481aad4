// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/weld.h"

#include <bit>
#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

std::uint64_t hash(const Vec3& v) noexcept {
  // Multiply and fold each coordinate in turn: meshes are full of regular patterns of bits.
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (int i = 0; i < 3; ++i) {
    h = (h ^ std::bit_cast<std::uint64_t>(v[i])) * 0xbf58476d1ce4e5b9u;
    h ^= h >> 31;
  }
  return h;
}

/// Numbers points by their first appearance; equal points get equal numbers.
class PointNumbers {
 public:
  explicit PointNumbers(std::size_t most)
      : slots_(std::bit_ceil(2 * most + 1), empty_), mask_(slots_.size() - 1) {}

  VertexId number(const Vec3& given, std::vector<Vec3>& points) {
    const Vec3 point = given.array() + 0.0;  // -0 becomes 0
    for (std::size_t s = hash(point) & mask_;; s = (s + 1) & mask_) {
      if (slots_[s] == empty_) {
        slots_[s] = static_cast<VertexId>(points.size());
        points.push_back(point);
        return slots_[s];
      }
      if (points[slots_[s]] == point) return slots_[s];
    }
  }

 private:
  static constexpr VertexId empty_ = ~VertexId{0};
  std::vector<VertexId> slots_;
  std::size_t mask_;
};

}  // namespace

Surface weld(Surface surface) {
  constexpr VertexId unnumbered = ~VertexId{0};
  PointNumbers numbers(surface.vertices.size());
  std::vector<VertexId> renumbered(surface.vertices.size(), unnumbered);
  std::vector<Vec3> points;
  points.reserve(surface.vertices.size() / 4);
  for (Corners& corners : surface.triangles) {
    for (VertexId& v : corners) {
      if (v >= surface.vertices.size()) {
        throw Error("a triangle names vertex " + std::to_string(v) + ", but there are only " +
                    std::to_string(surface.vertices.size()) + ": the file is damaged");
      }
      if (renumbered[v] == unnumbered) renumbered[v] = numbers.number(surface.vertices[v], points);
      v = renumbered[v];
    }
  }
  points.shrink_to_fit();
  surface.vertices = std::move(points);
  return surface;
}

}  // namespace keepout
