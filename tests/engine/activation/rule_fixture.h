// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "keepout/activation/activation.h"
#include "keepout/index/brute_force.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/step.h"

namespace keepout {

/// The planes that a rule activates at a tip.
inline std::vector<HalfSpace> planes_at(const std::shared_ptr<const Mesh>& mesh, Activation& rule,
                                        const Vec3& tip, double radius, double margin = 0.0) {
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  HalfSpaceBuffer planes(mesh->triangle_count());
  const Ball ball{tip, radius + margin};
  BruteForce(mesh).collect(ball, candidates);
  refine(*mesh, ball, candidates.view(), hits);
  rule.start({tip, Vec3::Zero(), margin, position_rounding(tip, {.radius = radius}), hits.view()},
             planes);
  return {planes.begin(), planes.end()};
}

}  // namespace keepout
