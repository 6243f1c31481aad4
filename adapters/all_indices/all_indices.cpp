// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/all_indices.h"

#include "../src/library_backends.h"

namespace keepout {

std::vector<IndexBackend> all_index_backends() {
  std::vector<IndexBackend> all;
  append(index_backends(), all);
#if KEEPOUT_HAS_CGAL
  append(cgal_indices(), all);
#endif
  return all;
}

std::vector<AbsentPart> all_absent_index_backends() {
  std::vector<AbsentPart> all;
  append(absent_index_backends(), all);
#if !KEEPOUT_HAS_CGAL
  all.push_back(
      {"cgal", "CGAL (install libcgal-dev, configure with KEEPOUT_WITH_CGAL=ON; under the GPL)"});
#endif
  return all;
}

}  // namespace keepout
