// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/all_indices.h"

#include "../src/library_backends.h"

namespace keepout {

std::vector<IndexBackend> all_index_backends() {
  return joined<IndexBackend>({
    index_backends(),
#if KEEPOUT_HAS_CGAL
        cgal_indices(),
#endif
  });
}

std::vector<AbsentPart> all_absent_index_backends() {
  std::vector<AbsentPart> all = joined<AbsentPart>({absent_index_backends()});
#if !KEEPOUT_HAS_CGAL
  all.push_back(
      {"cgal", "CGAL (install libcgal-dev, configure with KEEPOUT_WITH_CGAL=ON; under the GPL)"});
#endif
  return all;
}

}  // namespace keepout
