// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/parts.h"

#include "keepout/adapters/all_indices.h"

namespace keepout::app {

const std::vector<IndexBackend>& indices() {
  static const std::vector<IndexBackend> all = all_index_backends();
  return all;
}

const std::vector<AbsentPart>& absent_indices() {
  static const std::vector<AbsentPart> all = all_absent_index_backends();
  return all;
}

}  // namespace keepout::app
