// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "keepout/fixtures/random.h"
#include "keepout/step/motion_constraint.h"
#include "scene.h"

namespace keepout::app {

/// Where a tip is put down.
enum class Start : std::uint8_t {
  vertex,      // off a vertex, at the margin or a little more
  edge,        // off an edge
  face,        // off a face
  gap,         // in the middle between two walls, which the margin all but fills
  open_space,  // anywhere
  too_close,   // nearer than the margin
  on_surface,  // exactly on a vertex, an edge or a face, up to rounding
  behind       // on the side that the normals point away from
};

/// Where it is asked to go.
enum class Route : std::uint8_t {
  push,       // straight into the surface
  slide,      // into the surface and along it
  walk,       // anywhere, in steps of all lengths
  aim,        // at the corners and edges of the nearest triangle
  ping_pong,  // from wall to wall
  tremor,     // to a place behind the surface, trembling
  come_back,  // away from the surface, and back into it
  through     // to places far away, through whatever is in between
};

std::string_view name(Start start) noexcept;
std::string_view name(Route route) noexcept;

/// What a tip is guarded with, and asked to do.
struct Setup {
  StepOptions options;
  Inside inside = Inside::taken_as_is;
  Start start = Start::vertex;
  Route route = Route::push;
  double longest_step = 0.0;  // asked for [length], <= options.radius
  int joints = 0;             // columns of the Jacobian; 0: without one
  bool has_limits = false;    // on what each joint may do; only with joints
  Vec3 tip = Vec3::Zero();    // where it begins
};

/// Draws a setup. Never are more than some 1500 triangles in the motion sphere at the start, so
/// that a step takes microseconds.
Setup draw_setup(Scene& scene, Random& random);

}  // namespace keepout::app
