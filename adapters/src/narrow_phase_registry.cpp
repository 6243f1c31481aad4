// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/narrow_phase_registry.h"

#include "library_backends.h"

namespace keepout {
namespace {

constexpr NarrowPhaseBackend exact{
    "exact", "the engine's own kernel: proven distances, exact depths",
    make_narrow_phase_of<ExactNarrowPhase>, Allocation::never, nullptr};

}  // namespace

Registry<NarrowPhaseBackend> narrow_phase_backends() noexcept {
  static const std::vector<NarrowPhaseBackend> all = joined<NarrowPhaseBackend>({
    {&exact, 1},
#if KEEPOUT_HAS_CCD
        ccd_narrow_phases(),
#endif
#if KEEPOUT_HAS_FCL
        fcl_narrow_phases(),
#endif
  });
  static const std::vector<AbsentPart> absent {
#if !KEEPOUT_HAS_CCD
    {"ccd_gjk", needs_ccd}, {"ccd_mpr", needs_ccd},
#endif
#if !KEEPOUT_HAS_FCL
        {"fcl_gjk_libccd", needs_fcl}, {"fcl_gjk_indep", needs_fcl},
#endif
  };
  return {"narrow phase", all, absent};
}

std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool) {
  return narrow_phase_backends().named(name).make(tool);
}

}  // namespace keepout
