// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/ompl/guard_pool.h"

namespace keepout {

/// The place that a state of three real numbers stands for.
inline Vec3 tip_of(const ompl::base::State* state) noexcept {
  const double* values = state->as<ompl::base::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

inline void put(const Vec3& tip, ompl::base::State* state) noexcept {
  double* values = state->as<ompl::base::RealVectorStateSpace::StateType>()->values;
  values[0] = tip.x();
  values[1] = tip.y();
  values[2] = tip.z();
}

/// Throws Error unless the space is one of tips and the pool is there.
void require_tip_space(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                       const std::shared_ptr<GuardPool>& guards);

/// The bounds of a space of tips.
Box bounds_of(const ompl::base::SpaceInformation& space);

}  // namespace keepout
