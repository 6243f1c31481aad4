// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The principal direction tree: a binary tree of oriented boxes, the frame of each being the
/// principal axes of its triangles, split along the first of them.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997. Split at the median of the triangle centroids instead
/// of at their mean, so that the depth is bounded by the logarithm of the size, whatever the mesh.
class PdTree final : public SpatialIndex {
 public:
  explicit PdTree(std::shared_ptr<const Mesh> mesh);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override;
  std::size_t memory() const noexcept override;

 private:
  /// An oriented box around the triangles begin .. end of triangles_.
  struct Node {
    Eigen::Matrix3d axes;  // rows: the principal directions, largest spread first
    Vec3 center;           // of the box, in the mesh frame [length]
    Vec3 half;             // half of the box's size along each axis [length]
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t far_child;  // the near child is the next node; 0 for a leaf
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::span<const Vec3> centroids);
  Node enclose(std::uint32_t begin, std::uint32_t end, std::span<const Vec3> centroids) const;

  std::shared_ptr<const Mesh> mesh_;
  std::vector<TriangleId> triangles_;  // each subtree's are consecutive
  std::vector<Node> nodes_;            // a parent stands before its children
};

}  // namespace keepout
