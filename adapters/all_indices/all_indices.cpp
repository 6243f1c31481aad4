// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/all_indices.h"

#include "../src/library_backends.h"

namespace keepout {

Registry<IndexBackend> all_index_backends() {
  static const std::vector<IndexBackend> all = joined<IndexBackend>({
    index_backends(),
#if KEEPOUT_HAS_CGAL
        cgal_indices(),
#endif
  });
  static const std::vector<AbsentPart> absent = [] {
    std::vector<AbsentPart> parts = joined<AbsentPart>({index_backends().absent()});
#if !KEEPOUT_HAS_CGAL
    parts.push_back(
        {"cgal", "CGAL (install libcgal-dev, configure with KEEPOUT_WITH_CGAL=ON; under the GPL)"});
#endif
    return parts;
  }();
  return {"index", all, absent};
}

}  // namespace keepout
