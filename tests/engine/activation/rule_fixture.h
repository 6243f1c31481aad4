// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "keepout/activation/activation_rule.h"
#include "keepout/index/brute_force.h"
#include "keepout/mesh/mesh.h"
#include "step/input.h"

namespace keepout {

/// Returns the planes that a rule activates at a tip: those of open(), and those that reject trial
/// motions of length `radius` along and across the axes.
inline std::vector<HalfSpace> planes_at(const std::shared_ptr<const Mesh>& mesh,
                                        ActivationRule& rule, const Vec3& tip, double radius,
                                        double margin = 0.0) {
  Budget budget;
  Neighborhood near(mesh, std::make_shared<BruteForce>(mesh), mesh->triangle_count(), budget);
  HalfSpaceBuffer planes(mesh->triangle_count());
  const RuleInput input =
      rule_input_of({.tip = tip, .desired = Vec3::Zero()}, {.radius = radius, .margin = margin},
                    EndRegion::motion_sphere);
  rule.prepare(near);
  if (!rule.gather(input) || rule.open(input, planes).status != Status::free) return {};
  for (int i = 0; i < 27; ++i) {
    const Vec3 towards(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!towards.isZero()) rule.judge(input, radius * towards.normalized(), planes);
  }
  return {planes.begin(), planes.end()};
}

}  // namespace keepout
