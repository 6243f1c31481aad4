// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/moments.h"

#include <optional>
#include <utility>

namespace keepout::app {
namespace {

double clearance_at(const Simulation& simulation, const Moment& moment) {
  return simulation.runs[moment.run].strokes[moment.stroke].cycles[moment.cycle].clearance;
}

}  // namespace

Moment worst_moment(const Simulation& simulation, std::size_t run) {
  const Run& one = simulation.runs[run];
  Moment worst{run, 0, 0};
  for (std::size_t s = 0; s < one.strokes.size(); ++s) {
    for (std::size_t c = 0; c < one.strokes[s].cycles.size(); ++c) {
      const Moment moment{run, s, c};
      if (clearance_at(simulation, moment) < clearance_at(simulation, worst)) worst = moment;
    }
  }
  if (clearance_at(simulation, worst) >= 0.0 && !one.crossings.empty()) {
    worst = {run, one.crossings.front().stroke, one.crossings.front().cycle};
  }
  return worst;
}

Moment telling_moment(const Simulation& simulation) {
  // A rule that failed tells most, then what the fixture is for, then how near a rule came.
  const auto rank = [&](const Moment& moment) {
    const Run& run = simulation.runs[moment.run];
    const double clearance = clearance_at(simulation, moment);
    const int kind = clearance >= 0.0 && run.crossings.empty() ? 0 : run.rule == no_rule ? 1 : 2;
    return std::pair(kind, -clearance);
  };
  std::optional<Moment> best;
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    const Moment moment = worst_moment(simulation, r);
    if (!best || rank(moment) > rank(*best)) best = moment;
  }
  return *best;
}

}  // namespace keepout::app
