// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "keepout/factory/guide_text.h"
#include "tool.h"

/// Returns a number of the settings.
inline double number(const emscripten::val& settings, const char* name) {
  return settings[name].as<double>();
}

/// Returns the guides of the settings. Throws Error for a text that is no guide.
inline std::vector<keepout::Guide> guides_of(const emscripten::val& settings) {
  std::vector<keepout::Guide> guides;
  for (const std::string& text : emscripten::vecFromJSArray<std::string>(settings["guides"])) {
    guides.push_back(keepout::guide_of_text(text));
  }
  return guides;
}

/// Writes the limits that a step reports, for mesh and guides.
inline void show_limits(const auto& step, Cycle& cycle) noexcept {
  const std::span<const keepout::GuideState> states = step.guides;
  cycle.by_mesh = step.limits.has(keepout::Limit::mesh) ? 1.0 : 0.0;
  cycle.guides = 0.0;
  cycle.excess = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t g = 0; g < states.size(); ++g) {
    if (states[g].limits) cycle.guides += static_cast<double>(1U << g);
    cycle.excess = std::fmax(cycle.excess, states[g].excess);
  }
}
