// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/mesh.h"
#include "keepout/testing/places.h"

namespace keepout {

// Meshes that constraints and indices share: see also keepout/testing/places.h.

/// Returns one triangle in the plane x = `at`, larger than everything near it.
inline std::shared_ptr<const Mesh> wall(double at) {
  return mesh_of(Surface{{{at, -300, -300}, {at, 300, -300}, {at, 0, 300}}, {{0, 1, 2}}});
}

/// Returns a copy of the surface that a test can change.
inline Surface surface_of(const Mesh& mesh) {
  return {{mesh.vertices().begin(), mesh.vertices().end()},
          {mesh.triangles().begin(), mesh.triangles().end()}};
}

/// Returns the vertex with the largest z.
inline Vec3 highest_vertex(const Mesh& mesh) {
  Vec3 top = mesh.vertex(0);
  for (const Vec3& v : mesh.vertices()) {
    if (v.z() > top.z()) top = v;
  }
  return top;
}

// Surfaces small enough to be counted by hand.

/// Returns a tetrahedron with three right angles at the origin. Normals point outwards.
inline Surface tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// Returns one triangle in the plane z = 0, with its normal along z.
inline Surface single_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

/// Returns a torus about the z axis, with radii 3 and 1 and 2 * n * n triangles.
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

/// Returns both surfaces as one, without common vertices.
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

/// Returns the surface in another unit.
inline Surface enlarged(Surface surface, double factor) {
  for (Vec3& v : surface.vertices) v *= factor;
  return surface;
}

/// Returns a surface about the origin, moved outwards or inwards by up to 0.3. `time`: in beats.
inline Surface beating(Surface surface, double time) {
  const double swing = 0.3 * std::sin(2.0 * std::numbers::pi * time);
  for (Vec3& v : surface.vertices) v += swing * v.normalized();
  return surface;
}

/// Returns the surface with coordinates rounded to float, as in STL files.
inline Surface as_floats(Surface surface) {
  for (Vec3& v : surface.vertices) v = v.cast<float>().cast<double>();
  return surface;
}

/// Returns the surface without its last triangle, which leaves a hole in a closed surface.
inline Surface opened(Surface surface) {
  surface.triangles.pop_back();
  return surface;
}

/// Returns the surface with separate vertices for each triangle, as in STL files.
inline Surface unwelded(const Surface& surface) {
  Surface apart;
  for (const Corners& corners : surface.triangles) {
    const auto first = static_cast<VertexId>(apart.vertices.size());
    for (const VertexId v : corners) apart.vertices.push_back(surface.vertices[v]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

/// Returns the surface with the winding of all triangles reversed.
inline Surface flipped(Surface surface) {
  for (Corners& c : surface.triangles) std::swap(c[1], c[2]);
  return surface;
}

/// Returns the triangles in another order, each with its corners rotated. `new_ids` receives the
/// new number of each triangle.
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

/// Returns a normal random number with mean 0 and deviation 1, by Marsaglia's polar method. The
/// last bit depends on the system's logarithm.
inline double normal(Random& random) noexcept {
  while (true) {
    const double u = random.uniform(-1, 1);
    const double v = random.uniform(-1, 1);
    const double s = u * u + v * v;
    if (s > 0 && s < 1) return u * std::sqrt(-2 * std::log(s) / s);
  }
}

}  // namespace keepout
