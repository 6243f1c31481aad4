// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "chains.h"
#include "keepout/activation/certified.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"

namespace keepout {

// Constraints made of given parts; make_motion_constraint() makes them from names of parts.

template <class Index = WideBvh>
MotionConstraint guard_of(const std::shared_ptr<const Mesh>& mesh, const StepOptions& options,
                          std::unique_ptr<Solver> solver = std::make_unique<ActiveSet>(),
                          std::unique_ptr<ActivationRule> rule = std::make_unique<CertifiedRule>(),
                          const Capacity& capacity = {}) {
  return {mesh,    std::make_unique<Index>(mesh), std::move(rule), std::move(solver), options,
          capacity};
}

inline InstrumentConstraint guard_of(const std::shared_ptr<const Mesh>& mesh, Instrument instrument,
                                     const InstrumentOptions& options = {},
                                     const InstrumentCapacity& capacity = {}) {
  return {mesh,
          std::make_shared<WideBvh>(mesh),
          std::move(instrument),
          std::make_unique<ActiveSet>(),
          options,
          capacity};
}

/// Returns the joint positions after a fraction of a step.
inline std::vector<double> moved(std::vector<double> q, const InstrumentStep& step,
                                 double share = 1.0) {
  for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += share * step.increment[k];
  return q;
}

/// Returns the base of a psm that points straight down to a place, with its port `height` above it.
inline Pose port_over(const Vec3& place, double height) {
  const Instrument instrument = psm();
  const ChainState state =
      test::state_of(instrument.chain(), std::vector<double>{0, 0, 100, 0, 0, 0});
  const Vec3 way = state.flange().position.normalized();
  return {place + Vec3(0, 0, height), rotation_between(way, -Vec3::UnitZ()).toRotationMatrix()};
}

}  // namespace keepout
