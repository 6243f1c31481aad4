// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "../parallel.h"
#include "keepout/error.h"
#include "keepout/rounding_mode.h"
#include "mesh_file.h"
#include "weld_blocks.h"

namespace keepout {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_valid(const Vec3& v) noexcept {
  return std::abs(v.x()) <= largest_coordinate && std::abs(v.y()) <= largest_coordinate &&
         std::abs(v.z()) <= largest_coordinate;
}

void check_size(const Surface& surface) {
  if (surface.triangles.empty()) {
    throw Error("the mesh has no triangles: there is nothing to keep out of; check the export");
  }
  if (surface.triangles.size() >= no_triangle || surface.vertices.size() >= no_triangle) {
    throw Error("the mesh has more than 2^32 - 2 triangles or vertices: split or decimate it");
  }
}

void check_vertices(const Surface& surface, std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    if (!is_valid(surface.vertices[v])) {
      throw Error("vertex " + std::to_string(v) +
                  " has a coordinate that is not finite, or beyond 1e30: the file is damaged");
    }
  }
}

std::uint64_t next_id() noexcept {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

/// Measurements of some triangles.
struct Extent {
  Box bounds{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  double longest2 = 0.0;  // square of the longest edge
};

Extent extent_of(const Surface& surface, std::size_t begin, std::size_t end) {
  Extent extent;
  for (std::size_t t = begin; t < end; ++t) {
    Triangle corners;
    for (int i = 0; i < 3; ++i) {
      const VertexId v = surface.triangles[t][i];
      if (v >= surface.vertices.size()) {
        throw Error("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                    ", but there are only " + std::to_string(surface.vertices.size()) +
                    ": the file is damaged");
      }
      corners[i] = surface.vertices[v];
      extent.bounds.low = extent.bounds.low.cwiseMin(corners[i]);
      extent.bounds.high = extent.bounds.high.cwiseMax(corners[i]);
    }
    for (int e = 0; e < 3; ++e) {
      const Vec3 edge = corners[(e + 1) % 3] - corners[e];
      extent.longest2 = std::max(extent.longest2, edge.squaredNorm());
    }
  }
  return extent;
}

}  // namespace

Mesh::Mesh(Surface surface) : surface_(std::move(surface)), id_(next_id()) {
  require_rounding_to_nearest();
  check_size(surface_);
  share_ranges(vertex_count(), processors(),
               [&](std::size_t begin, std::size_t end) { check_vertices(surface_, begin, end); });
  std::vector<Extent> extents(triangle_count() / share_size + 1);
  share_ranges(triangle_count(), processors(), [&](std::size_t begin, std::size_t end) {
    extents[begin / share_size] = extent_of(surface_, begin, end);
  });
  Extent all;
  for (const Extent& extent : extents) {
    all.bounds.low = all.bounds.low.cwiseMin(extent.bounds.low);
    all.bounds.high = all.bounds.high.cwiseMax(extent.bounds.high);
    all.longest2 = std::max(all.longest2, extent.longest2);
  }
  bounds_ = all.bounds;
  longest_edge_ = std::sqrt(all.longest2);
}

Surface weld(Surface surface, unsigned threads) {
  const auto make_reader = [&] {
    return [&](std::size_t, std::span<Corners> triangles, auto&& number) {
      for (Corners& corners : triangles) {
        for (VertexId& v : corners) {
          if (v >= surface.vertices.size()) {
            throw Error("a triangle names vertex " + std::to_string(v) + ", but there are only " +
                        std::to_string(surface.vertices.size()) + ": the file is damaged");
          }
          const Vec3& given = surface.vertices[v];
          // -0 becomes 0
          v = number(ExactPoint<double>{given.x() + 0.0, given.y() + 0.0, given.z() + 0.0});
        }
      }
    };
  };
  return weld_blocks<double>(std::move(surface.triangles), thread_count(threads), make_reader);
}

}  // namespace keepout
