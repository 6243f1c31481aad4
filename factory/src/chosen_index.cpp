// SPDX-License-Identifier: BSD-3-Clause
#include "chosen_index.h"

#include <array>
#include <cstdio>
#include <utility>

#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/index/index_cache.h"

namespace keepout {

std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const std::string& name,
                                                       const std::filesystem::path& cache,
                                                       const Warn& warn) {
  if (cache.empty()) return make_index(name, std::move(mesh));
  if (name == "wide_bvh") return load_or_build(std::move(mesh), cache, warn);
  throw Error("index_cache: only the index wide_bvh can be stored, not '" + name +
              "'; omit index_cache");
}

void warn_of_coarse_index(const SpatialIndex& index, double kept, const Warn& warn) {
  const double rounding = index.rounding();
  if (!warn || !(32.0 * rounding > kept)) return;
  const auto length = [](double value) {
    std::array<char, 32> digits;
    std::snprintf(digits.data(), digits.size(), "%g", value);
    return std::string(digits.data());
  };
  warn("the mesh is so large relative to the distance kept that its index, which is off by up to " +
       length(rounding) +
       ", cannot distinguish the near triangles: steps are as safe, but slow, and shorter if "
       "that takes too long; keep more than " +
       length(32.0 * rounding) + ", or cut out the part of the mesh that matters");
}

}  // namespace keepout
