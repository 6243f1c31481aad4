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

/// What a tip is guarded with, and asked to do.
struct Setup {
  StepOptions options;
  Inside inside = Inside::taken_as_is;
  std::string_view start;  // the kind of place where the tip is put down
  Route route = Route::push;
  double tool_share = 0.0;    // of the distance kept that is the tool's radius, 0 to 1
  double longest_step = 0.0;  // asked for [length], <= options.radius
  int joints = 0;             // columns of the Jacobian; 0: without one
  bool has_limits = false;    // on what each joint may do; only with joints
  Vec3 tip = Vec3::Zero();    // where it begins

  /// Shares a distance out to tool radius and margin.
  void keep(double distance) noexcept;
};

/// A place on the surface.
struct SurfacePoint {
  Vec3 point;
  Vec3 normal;  // of a triangle there, to the free side
};
/// Anywhere on a triangle; each triangle is as likely.
SurfacePoint on_face(const Mesh& mesh, Random& random);

/// The largest StepOptions::nodes of any setup.
inline constexpr int most_nodes = 16;

/// The smallest distance to keep: well above what the engine refuses as lost in rounding. [length]
double least_distance_kept(const Scene& scene, double radius) noexcept;

/// Draws a setup. Never are more than some 1500 triangles in the motion sphere at the start, so
/// that a step takes microseconds.
Setup draw_setup(Scene& scene, Random& random);

}  // namespace keepout::app
