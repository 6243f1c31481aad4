// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "keepout/adapters/all_indices.h"
#include "keepout/registry.h"
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

/// The index of that name. Throws Error when there is none.
inline const IndexBackend& index_named(std::string_view name) {
  return entry_named(name, indices(), "index", absent_indices());
}

/// Whether a table of parts has one of that name.
bool has(const auto& table, std::string_view name) {
  return std::ranges::any_of(table, [&](const auto& entry) { return entry.name == name; });
}

}  // namespace keepout::app
