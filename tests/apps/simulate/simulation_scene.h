// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulate/simulation.h"
#include "small_surfaces.h"

namespace keepout::app {

inline Cycle cycle(const Vec3& tip, double clearance, float step_us = 0.0F,
                   Outcome outcome = Outcome::moved_freely) {
  return {tip, tip, clearance, step_us, outcome};
}

/// A stroke straight down at (0.2, 0.2), from above the base of the tetrahedron to a given height.
/// Clearance is that to the base alone, which is the nearest face here.
inline Stroke plunge(double lowest) {
  Stroke stroke;
  for (int i = 0; i <= 40; ++i) {
    const double height = -0.4 + (lowest + 0.4) * i / 40.0;
    stroke.cycles.push_back(cycle({0.2, 0.2, height}, -height, i % 2 == 0 ? 2.0F : 4.0F));
  }
  return stroke;
}

/// The base of the tetrahedron is the plane z = 0; free space is below it.
inline Simulation tetrahedron_simulation(const Mesh& mesh) {
  Simulation simulation{.mesh_name = "<tetra> & \"friends\"", .mesh = &mesh, .margin = 0.05};
  simulation.runs.push_back({.rule = no_rule, .description = "", .strokes = {plunge(0.15)}});
  simulation.runs.push_back({.rule = "safe", .description = "a < b", .strokes = {plunge(-0.05)}});
  simulation.runs.push_back({.rule = "leaky", .description = "", .strokes = {plunge(0.02)}});
  simulation.settings = {{"seed", "<1>"}};
  return simulation;
}

inline Surface square(double z, double half) {
  return {{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}},
          {{0, 1, 2}, {0, 2, 3}}};
}

/// A flat surface with its free side up, and a tip that slides over it for 40 mm.
inline Surface flat_ground() { return square(0, 50); }

inline Stroke slide(double height) {
  Stroke stroke;
  for (int i = 0; i <= 200; ++i) {
    const double raised = i < 50 ? 0.16 * (50 - i) : 0.0;
    stroke.cycles.push_back(cycle({0.2 * i - 20.0, 0.0, raised + height}, raised + height));
  }
  return stroke;
}

/// `depth` is that of the rule; the other rule touches, from the middle of the stroke to its end.
inline Simulation slides(const Mesh& mesh, double depth,
                         SurfaceKind surface = SurfaceKind::closed) {
  Simulation simulation{.mesh_name = "ground", .mesh = &mesh, .surface = surface};
  simulation.runs.push_back({.rule = no_rule, .description = "", .strokes = {slide(-4.0)}});
  simulation.runs.push_back({.rule = "rule", .description = "", .strokes = {slide(-depth)}});
  simulation.runs.push_back({.rule = "other", .description = "", .strokes = {slide(0.5)}});
  simulation.runs.back().strokes[0].cycles.back() = cycle({20, 0, 0}, 0.0);
  return simulation;
}

}  // namespace keepout::app
