// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"

namespace keepout {

/// Calls `visit(option, struct)` for each option of the settings of a constraint, with the struct
/// that has the option. The order is: settings, options, capacity.
template <class Settings, class Visit>
void for_each_option(Settings& settings, const Visit& visit) {
  for (const auto& option : table_of(settings)) visit(option, settings);
  for (const auto& option : table_of(settings.options)) visit(option, settings.options);
  for (const auto& option : table_of(settings.capacity)) visit(option, settings.capacity);
}

/// Returns the settings, their options or their capacity: the one of type `Options`.
template <class Options, class Settings>
const Options& part_of(const Settings& settings) {
  if constexpr (std::same_as<Options, Settings>) {
    return settings;
  } else if constexpr (std::same_as<Options, decltype(settings.options)>) {
    return settings.options;
  } else {
    return settings.capacity;
  }
}

}  // namespace keepout
