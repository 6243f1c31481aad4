// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "setup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "start.h"

namespace keepout::app {
namespace {

template <class Choice>
struct Weighted {
  Choice choice;
  double weight;
};

template <class Choice, std::size_t n>
Choice draw(const std::array<Weighted<Choice>, n>& choices, Random& random) {
  double total = 0.0;
  for (const auto& c : choices) total += c.weight;
  double left = random.uniform(0.0, total);
  for (const auto& c : choices) {
    left -= c.weight;
    if (left < 0.0) return c.choice;
  }
  return choices.back().choice;
}

constexpr std::array<Weighted<Start>, 8> starts{{{Start::vertex, 0.18},
                                                 {Start::edge, 0.18},
                                                 {Start::face, 0.14},
                                                 {Start::gap, 0.25},
                                                 {Start::open_space, 0.1},
                                                 {Start::too_close, 0.06},
                                                 {Start::on_surface, 0.03},
                                                 {Start::behind, 0.06}}};

constexpr std::array<Weighted<Route>, 8> routes{{{Route::push, 0.12},
                                                 {Route::slide, 0.2},
                                                 {Route::walk, 0.13},
                                                 {Route::aim, 0.15},
                                                 {Route::ping_pong, 0.1},
                                                 {Route::tremor, 0.1},
                                                 {Route::come_back, 0.08},
                                                 {Route::through, 0.12}}};

constexpr std::array<Weighted<int>, 5> refinements{
    {{0, 0.15}, {1, 0.1}, {2, 0.1}, {3, 0.55}, {10, 0.1}}};

constexpr std::array<Weighted<int>, 3> nodes{{{0, 0.85}, {4, 0.05}, {16, 0.1}}};

double log_uniform(double low, double high, Random& random) {
  return low * std::pow(high / low, random.uniform());
}

/// Makes way for the index: no step shall have more triangles in its motion sphere at the start.
void limit_reach(const Scene& scene, Setup& setup) {
  TriangleBuffer found(1500);
  for (int halvings = 0; halvings < 40; ++halvings) {
    found.clear();
    scene.index().collect({setup.tip, setup.options.radius + setup.options.margin}, found);
    if (!found.overflowed()) return;
    setup.options.radius *= 0.5;
    setup.longest_step *= 0.5;
    if (halvings < 8) continue;
    const double least = least_margin(scene, setup.options.radius);
    setup.options.margin = std::max(0.5 * setup.options.margin, least);
  }
}

}  // namespace

std::string_view name(Start start) noexcept {
  constexpr std::array<std::string_view, 8> names{
      "vertex", "edge", "face", "gap", "open_space", "too_close", "on_surface", "behind"};
  return names[static_cast<std::size_t>(start)];
}

std::string_view name(Route route) noexcept {
  constexpr std::array<std::string_view, 8> names{"push",      "slide",  "walk",      "aim",
                                                  "ping_pong", "tremor", "come_back", "through"};
  return names[static_cast<std::size_t>(route)];
}

Setup draw_setup(Scene& scene, Random& random) {
  Setup setup;
  setup.start = draw(starts, random);
  setup.route = draw(routes, random);
  setup.options.refinements = draw(refinements, random);
  setup.options.nodes = draw(nodes, random);
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
  const double least = least_margin(scene, setup.options.radius);
  const double low = random.uniform() < 0.125 ? least : std::max(1e-3 * edge, least);
  setup.options.margin = log_uniform(low, std::max(3.0 * edge, 2.0 * low), random);
  setup.options.recovery = log_uniform(1e-2, 2.0, random) * setup.options.margin;

  setup.tip = place_tip(scene, setup, random);
  limit_reach(scene, setup);
  setup.options.deepest = scene.mesh()->bounds().size().norm();
  return setup;
}

}  // namespace keepout::app
