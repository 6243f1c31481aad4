// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/narrow_phase_registry.h"

#include <iterator>

#if KEEPOUT_HAS_CCD
#include "../ccd/narrow_phase.h"
#endif
#if KEEPOUT_HAS_FCL
#include "../fcl/narrow_phase.h"
#endif

namespace keepout {
namespace {

std::unique_ptr<NarrowPhase> make_exact(const ConvexTool& tool) {
  return std::make_unique<ExactNarrowPhase>(tool);
}

constexpr NarrowPhaseBackend backends[] = {
    {"exact", "the engine's own kernel: proven distances, exact depths", make_exact,
     Allocation::never, nullptr},
#if KEEPOUT_HAS_CCD
    {"ccd_gjk", "GJK, and EPA for the depth", make_ccd_gjk, Allocation::inside, ccd_library},
    {"ccd_mpr", "Minkowski portal refinement: its depth is not the least", make_ccd_mpr,
     Allocation::inside, ccd_library},
#endif
#if KEEPOUT_HAS_FCL
    {"fcl_gjk_libccd", "GJK and EPA of FCL, after libccd", make_fcl_gjk_libccd, Allocation::inside,
     fcl_narrow_phase_library},
    {"fcl_gjk_indep", "GJK and EPA of FCL, its own", make_fcl_gjk_indep, Allocation::inside,
     fcl_narrow_phase_library},
#endif
};

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

std::span<const NarrowPhaseBackend> narrow_phase_backends() noexcept { return backends; }

std::span<const AbsentPart> absent_narrow_phase_backends() noexcept {
  return {absent, std::size(absent) - 1};
}

std::unique_ptr<NarrowPhase> make_narrow_phase(std::string_view name, const ConvexTool& tool) {
  return entry_named(name, backends, "narrow phase", absent_narrow_phase_backends()).make(tool);
}

}  // namespace keepout
