// SPDX-License-Identifier: BSD-3-Clause
#include "setup.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace keepout::app {
namespace {

/// One of the rows, each as often as its weight says.
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

/// Half of the tools are points; of the others some are kept off by their radius alone.
double draw_tool_share(Random& random) {
  const double kind = random.uniform();
  return kind < 0.5 ? 0.0 : kind < 0.6 ? 1.0 : random.uniform();
}

/// Makes way for the index: no step shall have more triangles in its motion sphere at the start.
void limit_reach(const Scene& scene, Setup& setup) {
  TriangleBuffer found(1500);
  for (int halvings = 0; halvings < 40; ++halvings) {
    const double kept = distance_kept(setup.options);
    found.clear();
    scene.index().collect({setup.tip, setup.options.radius + kept}, found);
    if (!found.overflowed()) return;
    setup.options.radius *= 0.5;
    setup.longest_step *= 0.5;
    if (halvings < 8) continue;
    setup.keep(std::max(0.5 * kept, least_distance_kept(scene, setup.options.radius)));
  }
}

}  // namespace

std::string_view name(Route route) noexcept { return routes[static_cast<std::size_t>(route)].name; }

void Setup::keep(double distance) noexcept {
  options.tool_radius = tool_share * distance;
  options.margin = distance - options.tool_radius;
}

Setup draw_setup(Scene& scene, Random& random) {
  Setup setup;
  setup.start = &draw(starts(), random);
  setup.route = draw(routes, random).route;
  setup.options.refinements = draw(refinements, random).value;
  setup.options.nodes = draw(nodes, random).value;
  setup.options.query = random.uniform() < 0.25 ? Query::sphere : Query::motion;
  if (scene.has_sides() && random.uniform() < 0.75) setup.inside = Inside::led_out;

  const double edge = scene.mean_edge();
  setup.longest_step = log_uniform(1e-3, 10.0, random) * edge;
  setup.options.radius = setup.longest_step;
  if (random.uniform() < 0.5) setup.options.radius *= random.uniform(1.0, 3.0);
  if (random.uniform() < 0.125) {
    setup.joints = 3 + static_cast<int>(random.below(5));
    setup.has_limits = random.uniform() < 0.5;
    // More joints than the tip has directions: only a damping makes their motion unique.
    const bool is_damped = setup.joints > 3 || random.uniform() < 0.5;
    if (is_damped) setup.options.damping = log_uniform(1e-6, 1.0, random);
  }
  const double least = least_distance_kept(scene, setup.options.radius);
  const double low = random.uniform() < 0.125 ? least : std::max(1e-3 * edge, least);
  const double kept = log_uniform(low, std::max(3.0 * edge, 2.0 * low), random);
  setup.tool_share = draw_tool_share(random);
  setup.keep(kept);
  setup.options.recovery = log_uniform(1e-2, 2.0, random) * kept;

  setup.tip = setup.start->place(scene, setup, random);
  limit_reach(scene, setup);
  setup.options.deepest = scene.mesh()->bounds().size().norm();
  return setup;
}

}  // namespace keepout::app
