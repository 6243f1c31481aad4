// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/narrow_phase_registry.h"

#include "keepout/module.h"
#include "needed_libraries.h"

namespace keepout {
namespace {

constexpr NarrowPhaseBackend ours[] = {{"exact",
                                        "the engine's own kernel: proven distances, exact depths",
                                        [](const ConvexTool& tool) -> std::unique_ptr<NarrowPhase> {
                                          return std::make_unique<ExactNarrowPhase>(tool);
                                        },
                                        Allocation::never, nullptr}};

constexpr PeerPart peers[] = {
    {"ccd_gjk", needs_ccd, "ccd"},
    {"ccd_mpr", needs_ccd, "ccd"},
    {"fcl_gjk_libccd", needs_fcl, "fcl"},
    {"fcl_gjk_indep", needs_fcl, "fcl"},
};

const PartTable<NarrowPhaseBackend>& table() {
  static const PartTable<NarrowPhaseBackend> table("narrow phase", ours, peers,
                                                   "keepout_narrow_phases");
  return table;
}

}  // namespace

Registry<NarrowPhaseBackend> narrow_phase_backends() { return table().all(); }

std::vector<std::string> narrow_phase_names() { return table().names(); }

std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool) {
  return table().named(name).make(tool);
}

}  // namespace keepout
