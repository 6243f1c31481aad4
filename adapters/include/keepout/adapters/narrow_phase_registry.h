// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/geometry/separation.h"
#include "keepout/registry.h"

namespace keepout {

/// A narrow phase that this build has.
struct NarrowPhaseBackend {
  std::string_view name;         // for make_narrow_phase
  std::string_view description;  // one line, for lists
  /// Makes one for a tool, like make_narrow_phase.
  std::unique_ptr<NarrowPhase> (*make)(const ConvexTool& tool);
  Allocation allocation;     // while it answers
  std::string (*library)();  // name and version of the library behind it; null for keepout's own
};

/// Returns all narrow phases, the exact kernel first. Those of libraries are for comparison: see
/// docs/convex_tools.md. Loads all modules that bring some (see keepout/module.h).
Registry<NarrowPhaseBackend> narrow_phase_backends();

/// Returns the names of the narrow phases that can be had. Loads no module.
std::vector<std::string> narrow_phase_names();

/// Returns the narrow phase of that name for a tool. Loads at most the module that brings it.
/// Throws Error for an unknown name.
std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool);

}  // namespace keepout

/// The table of a module that brings narrow phases.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::NarrowPhaseBackend>
    keepout_narrow_phases;
