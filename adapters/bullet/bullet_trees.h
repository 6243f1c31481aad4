// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <BulletCollision/CollisionShapes/btOptimizedBvh.h>

#include <cstddef>

#include "bullet_mesh.h"
#include "keepout/geometry/box.h"

namespace keepout {

// Bullet's trees, opened for our own walk. Both are arrays of nodes in which a parent stands before
// its children and knows how many nodes its subtree has: what is passed over is skipped.

inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

/// Nodes of 96 bytes: a box in double, the size of the subtree, the triangle.
class BulletTree final : public btOptimizedBvh {
 public:
  explicit BulletTree(BulletMesh& mesh) { build(&mesh, false, mesh.low(), mesh.high()); }

  int node_count() const noexcept { return m_curNodeIndex; }
  bool is_leaf(int node) const noexcept { return m_contiguousNodes[node].m_escapeIndex < 0; }
  int subtree_size(int node) const noexcept {
    return is_leaf(node) ? 1 : m_contiguousNodes[node].m_escapeIndex;
  }
  TriangleId triangle(int leaf) const noexcept {
    const btOptimizedBvhNode& node = m_contiguousNodes[leaf];
    return BulletMesh::triangle(node.m_subPart, node.m_triangleIndex);
  }
  Box box(int node) const noexcept {
    return {from_bullet(m_contiguousNodes[node].m_aabbMinOrg),
            from_bullet(m_contiguousNodes[node].m_aabbMaxOrg)};
  }
  std::size_t memory() const noexcept {
    return static_cast<std::size_t>(m_contiguousNodes.capacity()) * sizeof(btOptimizedBvhNode);
  }
};

/// Nodes of 16 bytes: a box of 16-bit coordinates, and the size of the subtree or the triangle.
class BulletQuantizedTree final : public btOptimizedBvh {
 public:
  explicit BulletQuantizedTree(BulletMesh& mesh) {
    build(&mesh, true, mesh.low(), mesh.high());
    origin_ = from_bullet(m_bvhAabbMin);
    step_ = from_bullet(m_bvhQuantization).cwiseInverse();
  }

  int node_count() const noexcept { return m_curNodeIndex; }
  bool is_leaf(int node) const noexcept { return m_quantizedContiguousNodes[node].isLeafNode(); }
  int subtree_size(int node) const noexcept {
    return is_leaf(node) ? 1 : m_quantizedContiguousNodes[node].getEscapeIndex();
  }
  TriangleId triangle(int leaf) const noexcept {
    const btQuantizedBvhNode& node = m_quantizedContiguousNodes[leaf];
    return BulletMesh::triangle(node.getPartId(), node.getTriangleIndex());
  }
  Box box(int node) const noexcept {
    const btQuantizedBvhNode& at = m_quantizedContiguousNodes[node];
    return {place(at.m_quantizedAabbMin), place(at.m_quantizedAabbMax)};
  }
  std::size_t memory() const noexcept {
    return static_cast<std::size_t>(m_quantizedContiguousNodes.capacity()) *
               sizeof(btQuantizedBvhNode) +
           static_cast<std::size_t>(m_SubtreeHeaders.capacity()) * sizeof(btBvhSubtreeInfo);
  }

 private:
  Vec3 place(const unsigned short (&steps)[3]) const noexcept {
    return origin_ + step_.cwiseProduct(Vec3(steps[0], steps[1], steps[2]));
  }

  Vec3 origin_;  // of the quantised coordinates
  Vec3 step_;    // of one of them
};

}  // namespace keepout
