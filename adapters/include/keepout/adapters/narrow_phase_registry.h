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

/// A narrow phase (NarrowPhase) that make_narrow_phase() makes by its name.
struct NarrowPhaseBackend {
  std::string_view name;         // for make_narrow_phase
  std::string_view description;  // one line, for lists
  /// Makes a narrow phase for a tool, like make_narrow_phase.
  std::unique_ptr<NarrowPhase> (*make)(const ConvexTool& tool);
  Allocation allocation;     // use of heap memory while it computes
  std::string (*library)();  // name and version of the underlying library; null for keepout's own
};

/// Returns all narrow phases, the exact kernel first. The narrow phases of other libraries are for
/// comparison: see docs/convex_tools.md. Loads all modules with narrow phases (see
/// keepout/module.h).
Registry<NarrowPhaseBackend> narrow_phase_backends();

/// Returns the names of the available narrow phases. Loads no module.
std::vector<std::string> narrow_phase_names();

/// Returns the narrow phase of that name for a tool. Loads no module except that of the narrow
/// phase. Throws Error for an unknown name.
std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool);

}  // namespace keepout

/// The table of the narrow phases of a module.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::NarrowPhaseBackend>
    keepout_narrow_phases;
