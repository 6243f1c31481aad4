// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/index_registry.h"

#include <iterator>
#include <utility>

#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/pd_tree_1997.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/registry.h"

#if KEEPOUT_HAS_FCL
#include "../fcl/fcl_index.h"
#endif
#if KEEPOUT_HAS_BULLET
#include "../bullet/bullet_index.h"
#endif
#if KEEPOUT_HAS_EMBREE
#include "../embree/embree_index.h"
#endif

namespace keepout {
namespace {

template <class T>
std::unique_ptr<SpatialIndex> make(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<T>(std::move(mesh));
}

constexpr std::size_t as_many_as_a_mesh = no_triangle;

constexpr IndexBackend backends[] = {
    {"brute_force", "every triangle, one after the other: the oracle", make<BruteForce>,
     as_many_as_a_mesh, nullptr},
    {"wide_bvh", "axis-aligned boxes and triangles sixteen at a time", make<WideBvh>,
     WideBvh::most_triangles, nullptr},
    {"pd_tree", "principal direction tree, split at the median, leaves sixteen at a time",
     make<PdTree>, PdTree::most_triangles, nullptr},
    {"pd_tree_1997", "principal direction tree as published: split at the mean, plain leaves",
     make<PdTree1997>, PdTree1997::most_triangles, nullptr, Allocation::never,
     "The tree of Williams et al. 1997 and Li et al. 2020: pd_tree without our split and leaves."},
#if KEEPOUT_HAS_FCL
    {"fcl_obbrss", "oriented boxes of FCL", make_fcl_obbrss_index, fcl_most_triangles, fcl_library},
    {"fcl_aabb", "axis-aligned boxes of FCL", make_fcl_aabb_index, fcl_most_triangles, fcl_library},
    {"fcl_collide", "oriented boxes of FCL, by its own collide(): takes memory, not for real time",
     make_fcl_collide_index, fcl_most_triangles, fcl_library, Allocation::inside,
     "FCL's collide() also tests each triangle, and makes a list of contacts on the heap at each "
     "query; the contact points are not asked for."},
#endif
#if KEEPOUT_HAS_BULLET
    {"bullet_quantized", "axis-aligned boxes of Bullet, in 16 bits", make_bullet_quantized_index,
     bullet_quantized_most_triangles, bullet_library},
    {"bullet", "axis-aligned boxes of Bullet", make_bullet_index, bullet_most_triangles,
     bullet_library},
    {"bullet_callback", "axis-aligned boxes of Bullet, in 16 bits, by its own walk and callback",
     make_bullet_callback_index, bullet_quantized_most_triangles, bullet_library, Allocation::never,
     "Bullet's walk takes a box, not a ball, and so finds more candidates; it calls back for each, "
     "without fetching the triangle's corners as processAllTriangles() would."},
#endif
#if KEEPOUT_HAS_EMBREE
    {"embree", "axis-aligned boxes of Embree, in float", make_embree_index, embree_most_triangles,
     embree_library},
#endif
};

// Its last entry is not one of them, for an array cannot be empty.
constexpr AbsentPart absent[] = {
#if !KEEPOUT_HAS_FCL
    {"fcl_obbrss", "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)"},
    {"fcl_aabb", "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)"},
    {"fcl_collide", "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)"},
#endif
#if !KEEPOUT_HAS_BULLET
    {"bullet_quantized",
     "Bullet (install libbullet-dev and pkg-config, configure with KEEPOUT_WITH_BULLET=ON)"},
    {"bullet",
     "Bullet (install libbullet-dev and pkg-config, configure with KEEPOUT_WITH_BULLET=ON)"},
    {"bullet_callback",
     "Bullet (install libbullet-dev and pkg-config, configure with KEEPOUT_WITH_BULLET=ON)"},
#endif
#if !KEEPOUT_HAS_EMBREE
    {"embree", "Embree 3 (install libembree-dev, configure with KEEPOUT_WITH_EMBREE=ON)"},
#endif
    {},
};

}  // namespace

std::span<const IndexBackend> index_backends() noexcept { return backends; }

std::span<const AbsentPart> absent_index_backends() noexcept {
  return std::span(absent).first(std::size(absent) - 1);
}

std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh) {
  return entry_named(name, backends, "index", absent_index_backends()).make(std::move(mesh));
}

}  // namespace keepout
