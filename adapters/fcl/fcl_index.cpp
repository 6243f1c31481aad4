// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/config.h>

#include <string_view>
#include <utility>

#include "fcl_model.h"
#include "keepout/geometry/ball_against_box.h"

namespace keepout {
namespace {

/// FCL's tree, walked by us: its own collide() tests the triangles as well, and takes memory.
template <class Volume>
class FclIndex final : public SpatialIndex {
 public:
  FclIndex(std::shared_ptr<const Mesh> mesh, std::string_view name)
      : model_(std::move(mesh), name) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, model_.mesh()->bounds());
    visit(0, ball.center, reach * reach, candidates);
  }

  std::size_t memory() const noexcept override { return model_.memory(); }

 private:
  // Recursive, as FCL's own build is: it splits at the mean, so that a depth has no bound but the
  // range of a double, some two thousand halvings.
  void visit(int node, const Vec3& point, double squared_reach,
             TriangleBuffer& candidates) const noexcept {
    const fcl::BVNode<Volume>& at = model_.tree().getBV(node);
    if (squared_distance(at.bv, point) > squared_reach) return;
    if (at.isLeaf()) {
      candidates.push(static_cast<TriangleId>(at.primitiveId()));
      return;
    }
    visit(at.leftChild(), point, squared_reach, candidates);
    visit(at.rightChild(), point, squared_reach, candidates);
  }

  FclModel<Volume> model_;
};

std::unique_ptr<SpatialIndex> make_obbrss(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<FclIndex<fcl::OBBRSSd>>(std::move(mesh), "fcl_obbrss");
}

std::unique_ptr<SpatialIndex> make_aabb(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<FclIndex<fcl::AABBd>>(std::move(mesh), "fcl_aabb");
}

std::string library() { return "FCL " FCL_VERSION; }

constexpr IndexBackend backends[] = {
    {"fcl_obbrss", "oriented boxes of FCL", make_obbrss, fcl_most_triangles, library},
    {"fcl_aabb", "axis-aligned boxes of FCL", make_aabb, fcl_most_triangles, library},
    {"fcl_collide", "oriented boxes of FCL, by its own collide(): takes memory, not for real time",
     make_fcl_collide_index, fcl_most_triangles, library, Allocation::inside,
     "FCL's collide() also tests each triangle, and makes a list of contacts on the heap at each "
     "query; the contact points are not asked for."},
};

}  // namespace

std::span<const IndexBackend> fcl_indices() noexcept { return backends; }

}  // namespace keepout
