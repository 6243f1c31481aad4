// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "keepout/adapters/all_indices.h"
#include "keepout/solvers/registry.h"

namespace keepout::app {

/// Every index that can be measured here: the library's, and those that are for comparison only.
inline const std::vector<IndexBackend>& indices() {
  static const std::vector<IndexBackend> all = all_index_backends();
  return all;
}

/// Those that this build was made without.
inline const std::vector<AbsentPart>& absent_indices() {
  static const std::vector<AbsentPart> all = all_absent_index_backends();
  return all;
}

}  // namespace keepout::app
