// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/gpl_index_registry.h"

#if KEEPOUT_HAS_CGAL
#include "cgal_index.h"
#endif

namespace keepout {

#if KEEPOUT_HAS_CGAL

namespace {

constexpr IndexBackend backends[] = {
    {"cgal", "AABB tree of CGAL", make_cgal_index, cgal_most_triangles, cgal_library},
};

}  // namespace

std::span<const IndexBackend> gpl_index_backends() noexcept { return backends; }
std::span<const AbsentPart> absent_gpl_index_backends() noexcept { return {}; }

#else

namespace {

constexpr AbsentPart absent[] = {
    {"cgal", "CGAL (install libcgal-dev, configure with KEEPOUT_WITH_CGAL=ON; under the GPL)"},
};

}  // namespace

std::span<const IndexBackend> gpl_index_backends() noexcept { return {}; }
std::span<const AbsentPart> absent_gpl_index_backends() noexcept { return absent; }

#endif

}  // namespace keepout
