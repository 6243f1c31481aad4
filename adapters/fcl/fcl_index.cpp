// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_index.h"

#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>

#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/geometry/ball_against_box.h"
#include "../src/capacity.h"
#include "bounding_volumes.h"
#include "keepout/error.h"

namespace keepout {
namespace {

/// FCL's tree, walked by us: its own distance() and collide() copy the model for each query, or
/// have answers of their own about what touches.
template <class Volume>
class FclIndex final : public SpatialIndex {
 public:
  FclIndex(std::shared_ptr<const Mesh> mesh, std::string_view name) : mesh_(std::move(mesh)) {
    require_at_most(fcl_most_triangles, mesh_->triangle_count(), "triangles", name);
    require_at_most(std::numeric_limits<int>::max(), mesh_->vertex_count(), "vertices", name);
    build();
    std::vector<TriangleId> triangles;
    triangles.reserve(mesh_->triangle_count());
    hold_triangles(0, triangles);
    if (triangles.size() != mesh_->triangle_count()) throw Error("FCL lost triangles of the mesh");
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, mesh_->bounds());
    visit(0, ball.center, reach * reach, candidates);
  }

  std::size_t memory() const noexcept override {
    const auto nodes = static_cast<std::size_t>(model_.getNumBVs());
    return nodes * (sizeof(fcl::BVNode<Volume>) + sizeof(unsigned)) +
           static_cast<std::size_t>(model_.num_tris) * sizeof(fcl::Triangle) +
           static_cast<std::size_t>(model_.num_vertices) * sizeof(fcl::Vector3d);
  }

 private:
  void build() {
    const std::vector<fcl::Vector3d> vertices(mesh_->vertices().begin(), mesh_->vertices().end());
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh_->triangle_count());
    for (const Corners& corners : mesh_->triangles()) {
      triangles.emplace_back(corners[0], corners[1], corners[2]);
    }
    // The counts are declared, or FCL allocates more than it needs.
    if (model_.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size())) !=
            fcl::BVH_OK ||
        model_.addSubModel(vertices, triangles) != fcl::BVH_OK ||
        model_.endModel() != fcl::BVH_OK) {
      throw Error("FCL could not build its tree; is there enough memory?");
    }
  }

  /// FCL's boxes are not taken on trust: the oriented ones leave corners out by up to 1e-10 of
  /// their size, one in eight of those of a CT skull. Each is made to hold its triangles. Appends
  /// the triangles of the subtree.
  void hold_triangles(int node, std::vector<TriangleId>& triangles) {
    fcl::BVNode<Volume>& at = model_.getBV(node);
    const std::size_t first = triangles.size();
    if (at.isLeaf()) {
      triangles.push_back(static_cast<TriangleId>(at.primitiveId()));
    } else {
      hold_triangles(at.leftChild(), triangles);
      hold_triangles(at.rightChild(), triangles);
    }
    if (!is_sound(at.bv)) start_anew(at.bv, mesh_->triangle(triangles[first])[0]);
    for (const TriangleId t : std::span(triangles).subspan(first)) {
      for (const Vec3& corner : mesh_->triangle(t)) include(at.bv, corner);
    }
  }

  // Recursive, as FCL's own build is: it splits at the mean, so that a depth has no bound but the
  // range of a double, some two thousand halvings.
  void visit(int node, const Vec3& point, double squared_reach,
             TriangleBuffer& candidates) const noexcept {
    const fcl::BVNode<Volume>& at = model_.getBV(node);
    if (squared_distance(at.bv, point) > squared_reach) return;
    if (at.isLeaf()) {
      candidates.push(static_cast<TriangleId>(at.primitiveId()));
      return;
    }
    visit(at.leftChild(), point, squared_reach, candidates);
    visit(at.rightChild(), point, squared_reach, candidates);
  }

  std::shared_ptr<const Mesh> mesh_;
  fcl::BVHModel<Volume> model_;
};

}  // namespace

std::unique_ptr<SpatialIndex> make_fcl_obbrss_index(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<FclIndex<fcl::OBBRSSd>>(std::move(mesh), "fcl_obbrss");
}

std::unique_ptr<SpatialIndex> make_fcl_aabb_index(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<FclIndex<fcl::AABBd>>(std::move(mesh), "fcl_aabb");
}

std::string fcl_library() { return "FCL " FCL_VERSION; }

}  // namespace keepout
