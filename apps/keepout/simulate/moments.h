// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "simulate/simulation.h"

namespace keepout::app {

/// One cycle of a simulation.
struct Moment {
  std::size_t run = 0;
  std::size_t stroke = 0;
  std::size_t cycle = 0;
};

/// The deepest penetration of a run, or else its first crossing, or else its nearest approach.
Moment worst_moment(const Simulation& simulation, std::size_t run);

/// The moment that tells most about the rules: the deepest penetration that a rule let happen, or
/// else a crossing, or else, as no rule failed, the worst of the run without a fixture.
/// Precondition: there is a run.
Moment telling_moment(const Simulation& simulation);

}  // namespace keepout::app
