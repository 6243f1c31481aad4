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

namespace keepout {

// Meshes as constraints and indices share them.

inline std::shared_ptr<const Mesh> mesh_of(Surface surface) {
  return std::make_shared<const Mesh>(std::move(surface));
}

/// Returns the generated shape of this name.
inline std::shared_ptr<const Mesh> mesh_of(std::string_view shape) {
  return mesh_of(make_shape(shape));
}

/// Returns one triangle in the plane x = `at`, larger than all that is near it.
inline std::shared_ptr<const Mesh> wall(double at) {
  return mesh_of(Surface{{{at, -300, -300}, {at, 300, -300}, {at, 0, 300}}, {{0, 1, 2}}});
}

/// Returns a copy, to be changed.
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

/// The same surface in another unit.
inline Surface enlarged(Surface surface, double factor) {
  for (Vec3& v : surface.vertices) v *= factor;
  return surface;
}

/// A surface about the origin that comes and goes by 0.3, at a time in beats.
inline Surface beating(Surface surface, double time) {
  const double swing = 0.3 * std::sin(2.0 * std::numbers::pi * time);
  for (Vec3& v : surface.vertices) v += swing * v.normalized();
  return surface;
}

/// The surface with its coordinates rounded to floats, as those of STL files are.
inline Surface as_floats(Surface surface) {
  for (Vec3& v : surface.vertices) v = v.cast<float>().cast<double>();
  return surface;
}

/// The surface with a hole where its last triangle was.
inline Surface opened(Surface surface) {
  surface.triangles.pop_back();
  return surface;
}

/// Each triangle with vertices of its own, as an STL reader gives them.
inline Surface unwelded(const Surface& surface) {
  Surface apart;
  for (const Corners& corners : surface.triangles) {
    const auto first = static_cast<VertexId>(apart.vertices.size());
    for (const VertexId v : corners) apart.vertices.push_back(surface.vertices[v]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
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

// More places to query a mesh at, beside those of keepout/fixtures/poses.h. "Size" is the diagonal
// of the mesh's bounds.

/// Evenly in the mesh's bounds, enlarged by a quarter of its size on all six sides.
inline std::vector<Vec3> random_points(const Mesh& mesh, std::size_t count, Random& random) {
  const Vec3 border = Vec3::Constant(0.25 * mesh.bounds().size().norm());
  const Vec3 low = mesh.bounds().low - border;
  const Vec3 high = mesh.bounds().high + border;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(low[axis], high[axis]);
  }
  return points;
}

/// In any direction, 1 to 1e4 sizes from the center of the bounds, each decade alike. The last bit
/// is up to the system's pow.
inline std::vector<Vec3> far_points(const Mesh& mesh, std::size_t count, Random& random) {
  const double size = mesh.bounds().size().norm();
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const Vec3 direction = random.direction();
    p = mesh.bounds().center() + size * std::pow(10, random.uniform(0, 4)) * direction;
  }
  return points;
}

/// Normal, mean 0 and deviation 1, by Marsaglia's polar method. The last bit is up to the system's
/// logarithm.
inline double normal(Random& random) noexcept {
  while (true) {
    const double u = random.uniform(-1, 1);
    const double v = random.uniform(-1, 1);
    const double s = u * u + v * v;
    if (s > 0 && s < 1) return u * std::sqrt(-2 * std::log(s) / s);
  }
}

}  // namespace keepout
