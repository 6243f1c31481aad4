// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "keepout/geometry/separation.h"
#include "keepout/registry.h"

namespace keepout {

/// One way to tell the distance between a convex tool and a triangle.
struct NarrowPhaseBackend {
  std::string_view name;         // to ask for it by
  std::string_view description;  // one line, for lists
  /// A new one for a tool; as make_narrow_phase.
  std::unique_ptr<NarrowPhase> (*make)(const ConvexTool& tool);
  Allocation allocation;     // whether it takes memory while it answers
  std::string (*library)();  // name and version of the library behind it; null for our own
};

/// All that this build has, the exact kernel first. Those of libraries are for comparison: see
/// docs/convex_tools.md.
Registry<NarrowPhaseBackend> narrow_phase_backends() noexcept;

/// The narrow phase of that name for a tool. Throws Error, listing the names there are, if there is
/// none.
std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool);

}  // namespace keepout
