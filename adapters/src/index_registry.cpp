// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/index_registry.h"

#include <utility>

#include "index_module.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/pd_tree_1997.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/module.h"
#include "needed_libraries.h"

namespace keepout {
namespace {

constexpr IndexBackend ours[] = {
    {"brute_force", "every triangle, one after the other: the reference", make_index_of<BruteForce>,
     no_triangle, nullptr},
    {"wide_bvh", "axis-aligned boxes and triangles sixteen at a time", make_index_of<WideBvh>,
     WideBvh::most_triangles, nullptr},
    {"pd_tree", "principal direction tree, split at the median, leaves sixteen at a time",
     make_index_of<PdTree>, PdTree::most_triangles, nullptr},
    {"pd_tree_1997", "principal direction tree as published: split at the mean, plain leaves",
     make_index_of<PdTree1997>, PdTree1997::most_triangles, nullptr, Allocation::never,
     "The tree of Williams et al. 1997 and Li et al. 2020: pd_tree without our split and leaves."},
};

constexpr PeerPart peers[] = {
    {"fcl_obbrss", needs_fcl, "fcl"},
    {"fcl_aabb", needs_fcl, "fcl"},
    {"fcl_collide", needs_fcl, "fcl"},
    {"bullet_quantized", needs_bullet, "bullet"},
    {"bullet", needs_bullet, "bullet"},
    {"bullet_callback", needs_bullet, "bullet"},
    {"embree",
     "Embree 3 (install keepout-modules; in the sources, install libembree-dev and set "
     "KEEPOUT_WITH_EMBREE=ON)",
     "embree"},
    {"cgal", "CGAL (install libcgal-dev, configure with KEEPOUT_WITH_CGAL=ON; under the GPL)",
     "cgal"},
};

PartTable<IndexBackend>& table() {
  static PartTable<IndexBackend> table("index", ours, peers, "keepout_indices");
  return table;
}

}  // namespace

Registry<IndexBackend> index_backends() { return table().all(); }

std::size_t add_index_backends(const std::string& plugin) { return table().add(plugin); }

std::vector<std::string> index_names() { return table().names(); }

std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh) {
  return table().named(name).make(std::move(mesh));
}

void require_at_most(std::size_t most, std::size_t count, std::string_view items,
                     std::string_view index) {
  if (count <= most) return;
  throw Error("the index '" + std::string(index) + "' holds at most " + std::to_string(most) + " " +
              std::string(items) + ", and the mesh has " + std::to_string(count) +
              "; use 'wide_bvh', which holds more, or decimate the mesh");
}

}  // namespace keepout
