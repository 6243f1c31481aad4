// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"

namespace keepout::app {

/// Every index that can be measured here: the library's, and those that are for comparison only.
const std::vector<IndexBackend>& indices();

/// Those that this build was made without.
const std::vector<AbsentPart>& absent_indices();

}  // namespace keepout::app
