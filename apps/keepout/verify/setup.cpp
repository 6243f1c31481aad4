// SPDX-License-Identifier: BSD-3-Clause
#include "verify/setup.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace keepout::app {
namespace {

/// Draws a row with a probability proportional to its weight.
template <class Rows>
const auto& draw(const Rows& rows, Random& random) {
  double total = 0.0;
  for (const auto& row : rows) total += row.weight;
  double left = random.uniform(0.0, total);
  for (const auto& row : rows) {
    left -= row.weight;
    if (left < 0.0) return row;
  }
  return rows.back();
}

struct Weighted {
  int value;
  double weight;
};
constexpr std::array<Weighted, 5> refinements{
    {{0, 0.15}, {1, 0.1}, {2, 0.1}, {3, 0.55}, {10, 0.1}}};
constexpr std::array<Weighted, 3> nodes{{{0, 0.85}, {4, 0.05}, {most_nodes, 0.1}}};

struct RouteKind {
  Route route;
  double weight;
  std::string_view name;
};
constexpr std::array<RouteKind, 8> routes{{{Route::push, 0.12, "push"},
                                           {Route::slide, 0.2, "slide"},
                                           {Route::walk, 0.13, "walk"},
                                           {Route::aim, 0.15, "aim"},
                                           {Route::ping_pong, 0.1, "ping_pong"},
                                           {Route::tremor, 0.1, "tremor"},
                                           {Route::come_back, 0.08, "come_back"},
                                           {Route::through, 0.12, "through"}}};

double log_uniform(double low, double high, Random& random) {
  return low * std::pow(high / low, random.uniform());
}

/// Draws the fraction of the required clearance that is the tool radius. Half of the tools are
/// points; some others have no margin.
double draw_tool_share(Random& random) {
  const double kind = random.uniform();
  return kind < 0.5 ? 0.0 : kind < 0.6 ? 1.0 : random.uniform();
}

/// Reduces radius and clearance until at most 1500 triangles are in the motion sphere at the start.
void limit_reach(const Scene& scene, Setup& setup) {
  TriangleBuffer found(1500);
  for (int halvings = 0; halvings < 40; ++halvings) {
    const double kept = required_clearance(setup.options);
    found.clear();
    scene.index().collect({setup.tip, setup.options.radius + kept}, found);
    if (!found.overflowed()) return;
    setup.options.radius *= 0.5;
    setup.longest_step *= 0.5;
    if (halvings < 8) continue;
    setup.keep(std::max(0.5 * kept, least_distance_kept(scene, setup.options.radius)));
  }
}

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

/// Draws a unit vector away from the surface, along the normal in half of the cases. It points to
/// either side if tips on either side are accepted.
Vec3 way_off(const Setup& setup, const SurfacePoint& place, Random& random) {
  const bool two_sided = setup.inside == Inside::taken_as_is;
  const double sign = two_sided && random.uniform() < 0.5 ? -1.0 : 1.0;
  const double slant = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 1.5);
  const Vec3 way = sign * place.normal + slant * random.direction();
  const double length = way.norm();
  return length > 0.0 ? Vec3(way / length) : random.direction();
}

/// Moves the point until its nearest triangle is `distance` away, in a few iterations.
Vec3 at_distance(Scene& scene, Vec3 point, double distance) {
  for (int i = 0; i < 6; ++i) {
    const Hit hit = scene.nearest(point, 1.01 * distance);
    const double now = hit.closest.distance;
    if (now == distance || !(now > 0.0)) break;
    point += hit.closest.offset * ((now - distance) / now);
  }
  return point;
}

/// Draws a distance: the required clearance, up to 1e-6 more, or up to 6 times as much.
double draw_distance(double kept, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.3) return kept;
  if (kind < 0.6) return kept * (1.0 + std::pow(10.0, random.uniform(-16.0, -6.0)));
  return kept * std::pow(10.0, random.uniform(0.0, 0.8));
}

template <SurfacePoint (*place)(const Mesh&, Random&)>
Vec3 off_the_surface(Scene& scene, Setup& setup, Random& random) {
  const double kept = required_clearance(setup.options);
  Vec3 tip = Vec3::Zero();
  for (int attempt = 0; attempt < 12; ++attempt) {
    const SurfacePoint on = place(*scene.mesh(), random);
    const double distance = draw_distance(kept, random);
    tip = on.point + distance * way_off(setup, on, random);
    // Other walls may be nearer than the first one.
    const double now = scene.nearest(tip, distance).closest.distance;
    if (now < kept) tip = at_distance(scene, tip, distance);
    if (scene.nearest(tip, distance).closest.distance >= kept * (1.0 - 1e-12)) break;
  }
  return tip;
}

/// Returns the center of the largest ball that touches the surface at a point and does not
/// intersect it. Source: Ma, Bae, Choi, "3D medial axis point approximation using nearest neighbors
/// and the normal field", The Visual Computer 28, 2012 (shrinking balls).
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
    if (has_shrunk && radius > least_distance_kept(scene, setup.options.radius)) break;
  }
  constexpr std::array<double, 6> fills{1.0, 1.0 - 1e-12, 1.0 - 1e-9, 0.999, 0.9, 0.4};
  const double distance = scene.nearest(center, radius).closest.distance;
  const double kept = fills[random.below(fills.size())] * distance;
  const double least = least_distance_kept(scene, setup.options.radius);
  if (kept > least && kept < 5.0 * scene.mean_edge()) setup.keep(kept);
  return center;
}

Vec3 too_close(Scene& scene, Setup& setup, Random& random) {
  const SurfacePoint on = on_any(*scene.mesh(), random);
  const double lost = std::pow(10.0, random.uniform(-9.0, 0.0));
  const double share = random.uniform() < 0.5 ? 1.0 - lost : lost;
  const double distance = share * required_clearance(setup.options);
  return at_distance(scene, on.point + distance * way_off(setup, on, random), distance);
}

Vec3 on_surface(Scene& scene, Setup&, Random& random) {
  return on_any(*scene.mesh(), random).point;
}

Vec3 behind(Scene& scene, Setup& setup, Random& random) {
  const SurfacePoint on = on_any(*scene.mesh(), random);
  const double depth =
      required_clearance(setup.options) * std::pow(10.0, random.uniform(-3.0, 0.7));
  return on.point - depth * on.normal;
}

Vec3 anywhere(Scene& scene, Setup& setup, Random& random) {
  const Box& bounds = scene.mesh()->bounds();
  Vec3 tip;
  for (int axis = 0; axis < 3; ++axis) {
    const double beyond = 3.0 * required_clearance(setup.options) + setup.options.radius;
    tip[axis] = random.uniform(bounds.low[axis] - beyond, bounds.high[axis] + beyond);
  }
  return tip;
}

/// A kind of start of a tip.
struct Start {
  std::string_view name;
  double weight;  // proportional to the probability
  /// Finds a start of this kind. In a gap, changes the required clearance so that it almost fills
  /// the gap.
  Vec3 (*place)(Scene& scene, Setup& setup, Random& random);
};
constexpr std::array<Start, 8> starts{{
    {"vertex", 0.18, off_the_surface<on_vertex>},  // at the required clearance or slightly farther
    {"edge", 0.18, off_the_surface<on_edge>},
    {"face", 0.14, off_the_surface<on_face>},
    {"gap", 0.25, in_a_gap},  // in the middle between two walls, with almost no free space left
    {"open_space", 0.1, anywhere},
    {"too_close", 0.06, too_close},    // closer than the required clearance
    {"on_surface", 0.03, on_surface},  // on a vertex, an edge or a face, up to rounding
    {"behind", 0.06, behind},          // on the side that the normals point away from
}};

}  // namespace

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

double least_distance_kept(const Scene& scene, double radius) noexcept {
  return 1e-8 * (scene.judged().longest_edge() + radius) + 1e-14 * (scene.farthest() + radius);
}

std::string_view name(Route route) noexcept { return routes[static_cast<std::size_t>(route)].name; }

void Setup::keep(double distance) noexcept {
  options.tool_radius = tool_share * distance;
  options.margin = distance - options.tool_radius;
}

Setup draw_setup(Scene& scene, Random& random) {
  Setup setup;
  const Start& start = draw(starts, random);
  setup.start = start.name;
  setup.route = draw(routes, random).route;
  setup.options.refinements = draw(refinements, random).value;
  setup.options.nodes = draw(nodes, random).value;
  setup.options.query = random.uniform() < 0.25 ? Query::sphere : Query::motion;
  if (scene.has_sides() && random.uniform() < 0.75) setup.inside = Inside::escape;

  const double edge = scene.mean_edge();
  setup.longest_step = log_uniform(1e-3, 10.0, random) * edge;
  setup.options.radius = setup.longest_step;
  if (random.uniform() < 0.5) setup.options.radius *= random.uniform(1.0, 3.0);
  if (random.uniform() < 0.125) {
    setup.joints = 3 + static_cast<int>(random.below(5));
    setup.has_limits = random.uniform() < 0.5;
    // With more joints than the tip has directions, only damping makes the motion unique.
    const bool is_damped = setup.joints > 3 || random.uniform() < 0.5;
    if (is_damped) setup.options.damping = log_uniform(1e-6, 1.0, random);
  }
  const double least = least_distance_kept(scene, setup.options.radius);
  const double low = random.uniform() < 0.125 ? least : std::max(1e-3 * edge, least);
  const double kept = log_uniform(low, std::max(3.0 * edge, 2.0 * low), random);
  setup.tool_share = draw_tool_share(random);
  setup.keep(kept);
  setup.options.recovery = log_uniform(1e-2, 2.0, random) * kept;

  setup.tip = start.place(scene, setup, random);
  limit_reach(scene, setup);
  setup.options.deepest = scene.mesh()->bounds().size().norm();
  return setup;
}

}  // namespace keepout::app
