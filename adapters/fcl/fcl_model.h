// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcl/geometry/bvh/BVH_model.h>

#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "../src/library_backends.h"
#include "bounding_volumes.h"
#include "keepout/error.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// FCL counts the nodes by an int, as 2 n - 1 of n triangles, of which 2 n must not overflow.
inline constexpr std::size_t fcl_most_triangles = (std::size_t{1} << 30) - 1;

/// FCL's own collide() of a sphere with its tree of oriented boxes (OBB), which lists what the
/// sphere touches. Takes memory while it answers: for comparison, not for real time.
std::unique_ptr<SpatialIndex> make_fcl_collide_index(std::shared_ptr<const Mesh> mesh);

/// FCL's tree over a mesh, each box made to hold its triangles.
template <class Volume>
class FclModel {
 public:
  /// `name`: of the index that it is for.
  FclModel(std::shared_ptr<const Mesh> mesh, std::string_view name) : mesh_(std::move(mesh)) {
    require_at_most(fcl_most_triangles, mesh_->triangle_count(), "triangles", name);
    require_at_most(std::numeric_limits<int>::max(), mesh_->vertex_count(), "vertices", name);
    build();
    std::vector<TriangleId> triangles;
    triangles.reserve(mesh_->triangle_count());
    hold_triangles(0, triangles);
    if (triangles.size() != mesh_->triangle_count()) throw Error("FCL lost triangles of the mesh");
  }

  const std::shared_ptr<const Mesh>& mesh() const noexcept { return mesh_; }
  const fcl::BVHModel<Volume>& tree() const noexcept { return model_; }

  std::size_t memory() const noexcept {
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

  std::shared_ptr<const Mesh> mesh_;
  fcl::BVHModel<Volume> model_;
};

}  // namespace keepout
