// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/OBBRSS.h>

#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "../src/library_backends.h"
#include "keepout/error.h"
#include "keepout/geometry/shapes.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// FCL counts the nodes by an int, as 2 n - 1 of n triangles, of which 2 n must not overflow.
inline constexpr std::size_t fcl_most_triangles = (std::size_t{1} << 30) - 1;

/// Grows FCL's box until it holds the vertex.
inline void include(fcl::AABBd& box, const Vec3& vertex) {
  box.min_ = box.min_.cwiseMin(vertex);
  box.max_ = box.max_.cwiseMax(vertex);
}

inline void include(fcl::OBBd& box, const Vec3& vertex) {
  const Vec3 local = box.axis.transpose() * (vertex - box.To);
  box.extent = box.extent.cwiseMax(local.cwiseAbs());
}

/// Makes a box of what need not be one: an empty box around the vertex.
inline void start_anew(fcl::AABBd& box, const Vec3& vertex) { box = fcl::AABBd(vertex); }

inline void start_anew(fcl::OBBd& box, const Vec3& vertex) {
  box = fcl::OBBd(Eigen::Matrix3d::Identity(), vertex, Vec3::Zero());
}

/// Whether distances to the box mean what they say.
inline bool is_sound(const fcl::AABBd& box) { return box.min_.allFinite() && box.max_.allFinite(); }

/// Lengths in the frame of the box are those of the mesh, to the rounding that the radius is padded
/// by. FCL's axes are, unless the squares of the coordinates overflow.
inline bool is_sound(const fcl::OBBd& box) {
  const Eigen::Matrix3d gram = box.axis.transpose() * box.axis;
  const double skew = (gram - Eigen::Matrix3d::Identity()).cwiseAbs().sum();
  // Written so that a NaN fails.
  return skew <= 3e-14 && box.To.allFinite() && box.extent.allFinite();
}

inline double squared_distance(const fcl::AABBd& box, const Vec3& point) noexcept {
  return (box.min_ - point).cwiseMax(point - box.max_).cwiseMax(0.0).squaredNorm();
}

inline double squared_distance(const fcl::OBBd& box, const Vec3& point) noexcept {
  const Vec3 local = box.axis.transpose() * (point - box.To);
  return (local.cwiseAbs() - box.extent).cwiseMax(0.0).squaredNorm();
}

// Of an OBBRSS the box is used.
inline void include(fcl::OBBRSSd& volume, const Vec3& vertex) { include(volume.obb, vertex); }
inline void start_anew(fcl::OBBRSSd& volume, const Vec3& vertex) { start_anew(volume.obb, vertex); }
inline bool is_sound(const fcl::OBBRSSd& volume) { return is_sound(volume.obb); }
inline double squared_distance(const fcl::OBBRSSd& volume, const Vec3& point) noexcept {
  return squared_distance(volume.obb, point);
}

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
