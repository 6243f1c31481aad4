// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/adapters/index_registry.h"

namespace keepout {

// Apart from index_backends(), for the sake of licences: what is linked with CGAL's tree, which is
// under the GPL, may be passed on under the GPL only. keepout itself never is.

/// The indices that stand on libraries under the GPL; none unless KEEPOUT_WITH_CGAL is ON.
std::span<const IndexBackend> gpl_index_backends() noexcept;

/// Those of them that this build was made without.
std::span<const AbsentPart> absent_gpl_index_backends() noexcept;

}  // namespace keepout
