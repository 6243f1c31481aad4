// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/narrow_phase_registry.h"

#include <iterator>

#include "library_backends.h"

namespace keepout {
namespace {

constexpr NarrowPhaseBackend exact{"exact",
                                   "the engine's own kernel: proven distances, exact depths",
                                   [](const ConvexTool& tool) -> std::unique_ptr<NarrowPhase> {
                                     return std::make_unique<ExactNarrowPhase>(tool);
                                   },
                                   Allocation::never, nullptr};

// Its last entry is not one of them, for an array cannot be empty.
constexpr AbsentPart absent[] = {
#if !KEEPOUT_HAS_CCD
    {"ccd_gjk", "libccd (install libccd-dev, configure with KEEPOUT_WITH_CCD=ON)"},
    {"ccd_mpr", "libccd (install libccd-dev, configure with KEEPOUT_WITH_CCD=ON)"},
#endif
#if !KEEPOUT_HAS_FCL
    {"fcl_gjk_libccd", "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)"},
    {"fcl_gjk_indep", "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)"},
#endif
    {}};

}  // namespace

std::span<const NarrowPhaseBackend> narrow_phase_backends() noexcept {
  static const std::vector<NarrowPhaseBackend> all = joined<NarrowPhaseBackend>({
    {&exact, 1},
#if KEEPOUT_HAS_CCD
        ccd_narrow_phases(),
#endif
#if KEEPOUT_HAS_FCL
        fcl_narrow_phases(),
#endif
  });
  return all;
}

std::span<const AbsentPart> absent_narrow_phase_backends() noexcept {
  return {absent, std::size(absent) - 1};
}

std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool) {
  return entry_named(name, narrow_phase_backends(), "narrow phase", absent_narrow_phase_backends())
      .make(tool);
}

}  // namespace keepout
