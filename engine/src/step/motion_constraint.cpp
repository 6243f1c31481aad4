// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

/// No query finds more triangles than there are. Throws before any memory is asked for.
Capacity fitted(Capacity capacity, const Mesh* mesh) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (capacity.planes > most || capacity.variables > most) {
    throw Error("a capacity of more than 2^31 - 1 planes or variables cannot be held");
  }
  if (mesh != nullptr) capacity.triangles = std::min(capacity.triangles, mesh->triangle_count());
  return capacity;
}

}  // namespace

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::unique_ptr<SpatialIndex> index,
                                   std::unique_ptr<Activation> activation,
                                   std::unique_ptr<Solver> solver, const StepOptions& options,
                                   const Capacity& capacity)
    : mesh_(std::move(mesh)),
      index_(std::move(index)),
      activation_(std::move(activation)),
      solver_(std::move(solver)),
      options_(options),
      work_(fitted(capacity, mesh_.get())) {
  if (!mesh_ || !index_ || !activation_ || !solver_) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  if (!is_ok(check({.tip = Vec3::Zero(), .desired = Vec3::Zero()}, options_))) {
    throw Error("the radius must be above zero, margin and damping not below, and all below 1e30");
  }
  solver_->reserve(static_cast<int>(work_.variables()), static_cast<int>(work_.planes.capacity()));
}

Step MotionConstraint::step(const Motion& motion) noexcept {
  return keepout::step(*mesh_, *index_, *activation_, *solver_, motion, options_, work_);
}

Step MotionConstraint::step(const Motion& motion, StageTimes& times) noexcept {
  return keepout::step(*mesh_, *index_, *activation_, *solver_, motion, options_, work_,
                       StageClock(times));
}

}  // namespace keepout
