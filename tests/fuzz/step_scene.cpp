// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/step_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "keepout/fixtures/shapes.h"

namespace keepout::fuzz {
namespace {

constexpr std::size_t most_vertices = 12;
constexpr std::size_t most_triangles = 24;

Surface any_triangles(Source& source) {
  Surface surface;
  const std::size_t vertices = 3 + source.below(most_vertices - 2);
  for (std::size_t v = 0; v < vertices; ++v) surface.vertices.push_back(source.point(10.0));
  const std::size_t triangles = 1 + source.below(most_triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    Corners& corners = surface.triangles.emplace_back();
    for (VertexId& corner : corners) corner = static_cast<VertexId>(source.below(vertices));
  }
  return surface;
}

/// Returns a tetrahedron of any form, with its normals outside or inside.
Surface any_tetrahedron(Source& source) {
  Surface surface{{}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  for (int v = 0; v < 4; ++v) surface.vertices.push_back(source.point(10.0));
  return surface;
}

/// Returns a height field of 4 x 4 vertices.
Surface any_terrain(Source& source) {
  Surface surface;
  constexpr VertexId n = 4;
  for (VertexId i = 0; i < n * n; ++i) {
    surface.vertices.emplace_back(5.0 * (i % n) - 7.5, 5.0 * (i / n) - 7.5,
                                  source.between(-3.0, 3.0));
    if (i % n == n - 1 || i / n == n - 1) continue;
    surface.triangles.push_back({i, i + 1, i + n + 1});
    surface.triangles.push_back({i, i + n + 1, i + n});
  }
  return surface;
}

Surface scaled(Surface surface, double factor) {
  for (Vec3& v : surface.vertices) v *= factor;
  return surface;
}

Surface any_surface(Source& source) {
  switch (source.below(8)) {
    case 0:
      return any_tetrahedron(source);
    case 1:
      return any_terrain(source);
    case 2:
      return scaled(make_cube(100.0), 0.2);
    case 3:
      return scaled(make_sphere(60.0), 0.2);
    case 4:
      return scaled(make_concave_sphere(60.0), 0.3);
    case 5:
      return scaled(make_thin_plates(100.0), 0.2);
    default:
      return any_triangles(source);
  }
}

}  // namespace

std::shared_ptr<const Mesh> any_mesh(Source& source) {
  Surface surface = any_surface(source);
  if (source.once_in(4)) surface = scaled(std::move(surface), source.magnitude(-3.0, 3.0));
  if (source.once_in(4)) {
    const Vec3 far = source.magnitude(0.0, 5.0) * source.direction();
    for (Vec3& v : surface.vertices) v += far;
  }
  if (source.once_in(4)) {
    for (Corners& c : surface.triangles) std::swap(c[1], c[2]);
  }
  return std::make_shared<const Mesh>(std::move(surface));
}

std::shared_ptr<const Mesh> deformed(const Mesh& mesh, Source& source) {
  Surface surface{{mesh.vertices().begin(), mesh.vertices().end()},
                  {mesh.triangles().begin(), mesh.triangles().end()}};
  const double most = source.magnitude(-4.0, -0.5) * size_of(mesh);
  const Vec3 all = most * source.point(1.0);
  const std::size_t single = source.below(surface.vertices.size());
  for (Vec3& v : surface.vertices) v += all;
  surface.vertices[single] += most * source.point(1.0);
  return std::make_shared<const Mesh>(std::move(surface));
}

double size_of(const Mesh& mesh) noexcept { return std::max(mesh.bounds().size().norm(), 1e-3); }

Vec3 place_near(const Mesh& mesh, double distance, Source& source) noexcept {
  const auto t =
      static_cast<TriangleId>(source.below(std::min<std::size_t>(mesh.triangle_count(), 256)));
  const Triangle corners = mesh.triangle(t);
  const double a = source.fraction();
  const double b = (1.0 - a) * source.fraction();
  const Vec3 point = corners[0] + a * (corners[1] - corners[0]) + b * (corners[2] - corners[0]);
  Vec3 away = mesh.normal(t);
  if (source.once_in(3)) away = -away;
  if (away.isZero(0.0) || source.once_in(3)) away = source.direction();
  return point + distance * away;
}

Region any_region(const Vec3& place, double size, Source& source) {
  const Vec3 origin = place + source.between(0.0, 1.0) * size * source.direction();
  const Vec3 direction = source.direction();
  const double radius = source.magnitude(-3.0, 0.3) * size;
  switch (source.below(4)) {
    case 0:
      return Region::half_space(origin, direction);
    case 1:
      return Region::slab(origin, direction, radius);
    case 2:
      return Region::tube(origin, direction, radius);
    default:
      return Region::ball(origin, radius);
  }
}

}  // namespace keepout::fuzz
