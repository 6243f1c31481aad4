// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/fixtures/random.h"
#include "keepout/step/motion_constraint.h"
#include "operators/attacker.h"
#include "scene.h"

namespace keepout::app {

/// Returns the name of a route of a tip.
std::string_view name(Route route) noexcept;

/// The options of a guarded tip, its start, and the commanded motion.
struct Setup {
  StepOptions options;
  Inside inside = Inside::taken_as_is;
  std::string_view start;  // the kind of start
  Route route = Route::push;
  double tool_share = 0.0;    // fraction of the required clearance that is the tool radius
  double longest_step = 0.0;  // of the command [length], <= options.radius
  int joints = 0;             // columns of the Jacobian; 0: no Jacobian
  bool has_limits = false;    // of each joint; only with joints
  Vec3 tip = Vec3::Zero();    // the start

  /// Splits a required clearance into tool radius and margin.
  void keep(double distance) noexcept;
};

/// A place on the surface.
struct SurfacePoint {
  Vec3 point;
  Vec3 normal;  // of a triangle there, towards the free side
};
/// Draws a place on a triangle; all triangles have the same probability.
SurfacePoint on_face(const Mesh& mesh, Random& random);

/// The largest StepOptions::nodes of any setup.
inline constexpr int most_nodes = 16;

/// Returns the smallest required clearance of setups. It is well above the clearances that the
/// engine rejects because rounding exceeds them. [length]
double least_distance_kept(const Scene& scene, double radius) noexcept;

/// Draws a setup with at most 1500 triangles in the motion sphere at the start, so that a step
/// takes microseconds.
Setup draw_setup(Scene& scene, Random& random);

}  // namespace keepout::app
