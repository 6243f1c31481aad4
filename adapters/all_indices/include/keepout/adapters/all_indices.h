// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "keepout/adapters/index_registry.h"

namespace keepout {

// For tests, benchmarks and the command, which compare all that there is. A program of yours links
// keepout::keepout, and nothing under the GPL.

/// index_backends(), then gpl_index_backends().
std::vector<IndexBackend> all_index_backends();

/// Those of either kind that this build was made without.
std::vector<AbsentPart> all_absent_index_backends();

}  // namespace keepout
