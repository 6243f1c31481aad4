// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "verify/scene.h"

namespace keepout::app {

/// What the oracle says of a path, over the whole of each straight piece.
struct PathVerdict {
  bool enters = false;         // some piece touches the mesh
  bool is_too_near = false;    // some piece comes nearer than is allowed
  std::size_t bad_pieces = 0;  // that do either
  double clearance = 0.0;      // the least distance from the mesh [mm]
  double length = 0.0;         // [mm]

  bool is_valid() const noexcept { return !enters && !is_too_near; }
};

/// The least distance that docs/certified-step.md promises of a margin: m - 3 tau. [mm]
double least_distance(const Scene& scene, double margin, double radius);

/// `least`: the distance allowed; anything exactly below it is too near. [mm] Precondition: two
/// points.
PathVerdict judge_path(const Scene& scene, std::span<const Vec3> points, double least);

}  // namespace keepout::app
