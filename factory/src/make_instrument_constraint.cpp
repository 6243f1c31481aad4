// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_instrument_constraint.h"

#include <algorithm>
#include <utility>

#include "chosen_index.h"
#include "keepout/error.h"
#include "keepout/monitor/monitors.h"
#include "keepout/solvers/registry.h"

namespace keepout {

InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings) {
  if (!mesh) throw Error("an instrument constraint needs a mesh, but it is null");
  auto index = make_or_load_index(mesh, settings.index, settings.index_cache, settings.warn);
  return make_instrument_constraint(std::move(mesh), std::move(index), std::move(instrument),
                                    settings);
}

InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                std::shared_ptr<const SpatialIndex> index,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings) {
  if (!mesh) throw Error("an instrument constraint needs a mesh, but it is null");
  double thinnest = longest_length;
  for (const Body& body : instrument.bodies()) thinnest = std::min(thinnest, body.radius);
  InstrumentConstraint constraint(mesh, index, std::move(instrument), make_solver(settings.solver),
                                  settings.options, settings.capacity);
#if KEEPOUT_BALLS_ONLY
  if (settings.monitor) throw Error("this build has no monitor");
#else
  if (settings.monitor) {
    constraint.set_monitor(monitor::make_instrument_monitor(constraint.instrument(), {{mesh}}));
  }
#endif
  // After the settings are accepted, so that rejected settings cause no warning.
  warn_of_coarse_index(*index, thinnest + settings.options.margin, settings.warn);
  return constraint;
}

}  // namespace keepout
