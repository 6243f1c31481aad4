// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "keepout/mesh/mesh.h"

namespace keepout {

// Surfaces small enough to be counted by hand.

/// The corner of a cube cut off: three right angles at the origin; normals point outwards.
inline Surface tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// One triangle in the plane z = 0, its normal along z.
inline Surface single_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

/// A torus about the z axis, radii 3 and 1, of 2 * n * n triangles.
inline Surface torus(VertexId n) {
  Surface surface;
  const auto angle = [&](VertexId i) { return 2.0 * std::numbers::pi * i / n; };
  const auto number = [&](VertexId i, VertexId j) { return (i % n) * n + j % n; };
  for (VertexId i = 0; i < n; ++i) {
    for (VertexId j = 0; j < n; ++j) {
      const double radius = 3.0 + std::cos(angle(j));
      surface.vertices.emplace_back(radius * std::cos(angle(i)), radius * std::sin(angle(i)),
                                    std::sin(angle(j)));
      surface.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      surface.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  return surface;
}

/// Both in one, sharing nothing but the frame.
inline Surface together(Surface one, const Surface& other) {
  const auto first = static_cast<VertexId>(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Corners& c : other.triangles) {
    one.triangles.push_back({first + c[0], first + c[1], first + c[2]});
  }
  return one;
}

inline Surface moved(Surface surface, const Vec3& by) {
  for (Vec3& v : surface.vertices) v += by;
  return surface;
}

/// The same surface seen from its other side.
inline Surface flipped(Surface surface) {
  for (Corners& c : surface.triangles) std::swap(c[1], c[2]);
  return surface;
}

/// The same triangles in another order, each begun at another of its corners; and where each went.
inline Surface shuffled(Surface surface, unsigned seed,
                        std::vector<TriangleId>* new_ids = nullptr) {
  std::mt19937 random(seed);
  std::vector<TriangleId> order(surface.triangles.size());
  for (TriangleId t = 0; t < order.size(); ++t) order[t] = t;
  std::shuffle(order.begin(), order.end(), random);
  if (new_ids != nullptr) new_ids->resize(order.size());
  std::vector<Corners> triangles;
  for (const TriangleId t : order) {
    if (new_ids != nullptr) (*new_ids)[t] = static_cast<TriangleId>(triangles.size());
    Corners c = surface.triangles[t];
    std::rotate(c.begin(), c.begin() + random() % 3, c.end());
    triangles.push_back(c);
  }
  surface.triangles = std::move(triangles);
  return surface;
}

}  // namespace keepout
