// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/parts.h"

namespace keepout::app {

const std::vector<IndexBackend>& indices() {
  static const std::vector<IndexBackend> all(index_backends().begin(), index_backends().end());
  return all;
}

const std::vector<AbsentPart>& absent_indices() {
  static const std::vector<AbsentPart> all(absent_index_backends().begin(),
                                           absent_index_backends().end());
  return all;
}

}  // namespace keepout::app
