// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace keepout::app {
namespace {

struct SurfacePoint {
  Vec3 point;
  Vec3 normal;  // of a triangle there, to the free side
};

TriangleId any_triangle(const Mesh& mesh, Random& random) {
  return static_cast<TriangleId>(random.below(mesh.triangle_count()));
}

SurfacePoint on_vertex(const Mesh& mesh, Random& random) {
  const TriangleId t = any_triangle(mesh, random);
  return {mesh.triangle(t)[random.below(3)], mesh.normal(t)};
}

SurfacePoint on_edge(const Mesh& mesh, Random& random) {
  const TriangleId t = any_triangle(mesh, random);
  const Triangle c = mesh.triangle(t);
  const std::size_t e = random.below(3);
  const double share = random.uniform() < 0.5 ? 0.5 : random.uniform();
  return {c[e] + share * (c[(e + 1) % 3] - c[e]), mesh.normal(t)};
}

SurfacePoint on_face(const Mesh& mesh, Random& random) {
  const TriangleId t = any_triangle(mesh, random);
  const Triangle c = mesh.triangle(t);
  double a = random.uniform();
  double b = random.uniform();
  if (a + b > 1.0) {
    a = 1.0 - a;
    b = 1.0 - b;
  }
  return {c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]), mesh.normal(t)};
}

SurfacePoint on_any(const Mesh& mesh, Random& random) {
  switch (random.below(3)) {
    case 0:
      return on_vertex(mesh, random);
    case 1:
      return on_edge(mesh, random);
    default:
      return on_face(mesh, random);
  }
}

/// Off the surface at some slant: half of the time straight. Either side, if the surface has none.
Vec3 way_off(const Setup& setup, const SurfacePoint& place, Random& random) {
  const bool two_sided = setup.inside == Inside::taken_as_is;
  const double sign = two_sided && random.uniform() < 0.5 ? -1.0 : 1.0;
  const double slant = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 1.5);
  const Vec3 way = sign * place.normal + slant * random.direction();
  const double length = way.norm();
  return length > 0.0 ? Vec3(way / length) : random.direction();
}

/// Moves the point until its nearest triangle is `distance` away, if that comes to an end.
Vec3 at_distance(Scene& scene, Vec3 point, double distance) {
  for (int i = 0; i < 6; ++i) {
    const Hit hit = scene.nearest(point, 1.01 * distance);
    const double now = hit.closest.distance;
    if (now == distance || !(now > 0.0)) break;
    point += hit.closest.offset * ((now - distance) / now);
  }
  return point;
}

/// The margin, to the last digit or nearly so, or up to several of it.
double draw_distance(double margin, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.3) return margin;
  if (kind < 0.6) return margin * (1.0 + std::pow(10.0, random.uniform(-16.0, -6.0)));
  return margin * std::pow(10.0, random.uniform(0.0, 0.8));
}

Vec3 off_the_surface(Scene& scene, const Setup& setup, SurfacePoint (*place)(const Mesh&, Random&),
                     Random& random) {
  const double margin = setup.options.margin;
  Vec3 tip = Vec3::Zero();
  for (int attempt = 0; attempt < 12; ++attempt) {
    const SurfacePoint on = place(*scene.mesh(), random);
    const double distance = draw_distance(margin, random);
    tip = on.point + distance * way_off(setup, on, random);
    // Other walls may be nearer than the one it was put off from.
    const double now = scene.nearest(tip, distance).closest.distance;
    if (now < margin) tip = at_distance(scene, tip, distance);
    if (scene.nearest(tip, distance).closest.distance >= margin * (1.0 - 1e-12)) break;
  }
  return tip;
}

/// The centre of the largest ball that touches the surface in a point and nowhere cuts it: as far
/// from another wall. Source: Ma, Bae, Choi, "3D medial axis point approximation using nearest
/// neighbors and the normal field", The Visual Computer 28, 2012 (shrinking balls).
Vec3 in_a_gap(Scene& scene, Setup& setup, Random& random) {
  Vec3 center = Vec3::Zero();
  double radius = 0.0;
  for (int attempt = 0; attempt < 12; ++attempt) {
    const SurfacePoint on = on_any(*scene.mesh(), random);
    const Vec3 way = way_off(setup, on, random);
    radius = 20.0 * scene.mean_edge();
    bool has_shrunk = false;
    for (int i = 0; i < 40; ++i) {
      center = on.point + radius * way;
      const Hit hit = scene.nearest(center, radius);
      if (hit.closest.distance >= radius * (1.0 - 1e-10)) break;
      const Vec3 chord = center + hit.closest.offset - on.point;
      const double next = chord.squaredNorm() / (2.0 * way.dot(chord));
      if (!(next > 0.0) || !(next < radius)) break;
      radius = next;
      has_shrunk = true;
    }
    if (has_shrunk && radius > least_margin(scene, setup.options.radius)) break;
  }
  constexpr std::array<double, 6> fills{1.0, 1.0 - 1e-12, 1.0 - 1e-9, 0.999, 0.9, 0.4};
  const double distance = scene.nearest(center, radius).closest.distance;
  const double margin = fills[random.below(fills.size())] * distance;
  const double least = least_margin(scene, setup.options.radius);
  if (margin > least && margin < 5.0 * scene.mean_edge()) setup.options.margin = margin;
  return center;
}

Vec3 too_close(Scene& scene, const Setup& setup, Random& random) {
  const SurfacePoint on = on_any(*scene.mesh(), random);
  const double lost = std::pow(10.0, random.uniform(-9.0, 0.0));
  const double share = random.uniform() < 0.5 ? 1.0 - lost : lost;
  const double distance = share * setup.options.margin;
  return at_distance(scene, on.point + distance * way_off(setup, on, random), distance);
}

Vec3 anywhere(const Scene& scene, const Setup& setup, Random& random) {
  const Box& bounds = scene.mesh()->bounds();
  Vec3 tip;
  for (int axis = 0; axis < 3; ++axis) {
    const double beyond = 3.0 * setup.options.margin + setup.options.radius;
    tip[axis] = random.uniform(bounds.low[axis] - beyond, bounds.high[axis] + beyond);
  }
  return tip;
}

}  // namespace

double least_margin(const Scene& scene, double radius) noexcept {
  return 1e-8 * (scene.longest_edge() + radius) + 1e-14 * (scene.farthest() + radius);
}

Vec3 place_tip(Scene& scene, Setup& setup, Random& random) {
  switch (setup.start) {
    case Start::vertex:
      return off_the_surface(scene, setup, on_vertex, random);
    case Start::edge:
      return off_the_surface(scene, setup, on_edge, random);
    case Start::face:
      return off_the_surface(scene, setup, on_face, random);
    case Start::gap:
      return in_a_gap(scene, setup, random);
    case Start::too_close:
      return too_close(scene, setup, random);
    case Start::on_surface:
      return on_any(*scene.mesh(), random).point;
    case Start::behind: {
      const SurfacePoint on = on_any(*scene.mesh(), random);
      return on.point -
             setup.options.margin * std::pow(10.0, random.uniform(-3.0, 0.7)) * on.normal;
    }
    case Start::open_space:
      break;
  }
  return anywhere(scene, setup, random);
}

}  // namespace keepout::app
