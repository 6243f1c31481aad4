// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/mesh.h"

#include <cmath>
#include <string>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

// Fourth powers of lengths must stay finite and in range; no anatomy comes near.
constexpr double largest_coordinate = 1e30;

bool is_valid(const Vec3& v) noexcept {
  return std::abs(v.x()) <= largest_coordinate && std::abs(v.y()) <= largest_coordinate &&
         std::abs(v.z()) <= largest_coordinate;
}

void check(const Surface& surface) {
  if (surface.triangles.empty()) {
    throw Error("the mesh has no triangles: there is nothing to keep out of; check the export");
  }
  if (surface.triangles.size() >= no_triangle || surface.vertices.size() >= no_triangle) {
    throw Error("the mesh has more than 2^32 - 2 triangles or vertices: split or decimate it");
  }
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (!is_valid(surface.vertices[v])) {
      throw Error("vertex " + std::to_string(v) +
                  " has a coordinate that is not finite, or beyond 1e30: the file is damaged");
    }
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const VertexId v : surface.triangles[t]) {
      if (v >= surface.vertices.size()) {
        throw Error("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                    ", but there are only " + std::to_string(surface.vertices.size()) +
                    ": the file is damaged");
      }
    }
  }
}

Box bounds_of(const Surface& surface) {
  const Vec3& first = surface.vertices[surface.triangles.front().front()];
  Box box{first, first};
  for (const Corners& corners : surface.triangles) {
    for (const VertexId v : corners) {
      box.low = box.low.cwiseMin(surface.vertices[v]);
      box.high = box.high.cwiseMax(surface.vertices[v]);
    }
  }
  return box;
}

}  // namespace

Mesh::Mesh(Surface surface) : surface_(std::move(surface)) {
  check(surface_);
  bounds_ = bounds_of(surface_);
}

double longest_edge(const Mesh& mesh) noexcept {
  double longest2 = 0.0;
  for (const Corners& c : mesh.triangles()) {
    for (int e = 0; e < 3; ++e) {
      const Vec3 edge = mesh.vertex(c[(e + 1) % 3]) - mesh.vertex(c[e]);
      longest2 = std::max(longest2, edge.squaredNorm());
    }
  }
  return std::sqrt(longest2);
}

}  // namespace keepout
