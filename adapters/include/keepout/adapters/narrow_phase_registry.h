// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

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

/// Returns all narrow phases of this build, the exact kernel first. Those of libraries are for
/// comparison: see docs/convex_tools.md.
Registry<NarrowPhaseBackend> narrow_phase_backends() noexcept;

/// Makes the narrow phase of that name for a tool. Throws Error, which lists the names, for an
/// unknown one.
std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool);

}  // namespace keepout
