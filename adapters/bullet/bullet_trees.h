// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <BulletCollision/CollisionShapes/btOptimizedBvh.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <cstddef>
#include <string_view>

#include "../src/centered_frame.h"
#include "keepout/error.h"
#include "keepout/mesh/mesh.h"

// Debian ships Bullet in both precisions, and the one links with headers set for the other.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");

namespace keepout {

/// The mesh as Bullet's trees read it when they are built: in a centered frame, without a copy, and
/// in parts of as many triangles as a quantised node can number.
class BulletMesh final : public btStridingMeshInterface {
 public:
  static constexpr int bits_in_part = 31 - MAX_NUM_PARTS_IN_BITS;

  BulletMesh(const Mesh& mesh, const CenteredFrame& frame) : mesh_(mesh), frame_(frame) {}

  static btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

  /// The triangle that Bullet knows by its part and its number in it.
  static TriangleId triangle(int part, int number) {
    return (static_cast<TriangleId>(part) << bits_in_part) | static_cast<TriangleId>(number);
  }

  btVector3 low() const { return bullet(frame_.from_mesh(mesh_.bounds().low)); }
  btVector3 high() const { return bullet(frame_.from_mesh(mesh_.bounds().high)); }

  void InternalProcessAllTriangles(btInternalTriangleIndexCallback* callback, const btVector3&,
                                   const btVector3&) const override {
    for (TriangleId t = 0; t < mesh_.triangle_count(); ++t) {
      btVector3 corners[3];
      for (int i = 0; i < 3; ++i) corners[i] = bullet(frame_.from_mesh(mesh_.triangle(t)[i]));
      callback->internalProcessTriangleIndex(corners, static_cast<int>(t >> bits_in_part),
                                             static_cast<int>(t & ((1u << bits_in_part) - 1)));
    }
  }

  // The rest is asked for by other users of such a mesh, never by a tree.
  void getLockedVertexIndexBase(unsigned char**, int&, PHY_ScalarType&, int&, unsigned char**, int&,
                                int&, PHY_ScalarType&, int) override {
    refuse();
  }
  void getLockedReadOnlyVertexIndexBase(const unsigned char**, int&, PHY_ScalarType&, int&,
                                        const unsigned char**, int&, int&, PHY_ScalarType&,
                                        int) const override {
    refuse();
  }
  void unLockVertexBase(int) override {}
  void unLockReadOnlyVertexBase(int) const override {}
  int getNumSubParts() const override {
    return static_cast<int>((mesh_.triangle_count() - 1) >> bits_in_part) + 1;
  }
  void preallocateVertices(int) override {}
  void preallocateIndices(int) override {}

 private:
  [[noreturn]] static void refuse() { throw Error("this Bullet asks for a copy of the mesh"); }

  const Mesh& mesh_;
  const CenteredFrame& frame_;
};

// Bullet's trees, opened for our own walk. Both are arrays of nodes in which a parent stands before
// its children and knows how many nodes its subtree has: what is passed over is skipped.

inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

/// Nodes of 96 bytes: a box in double, the size of the subtree, the triangle.
class BulletTree final : public btOptimizedBvh {
 public:
  static constexpr std::string_view name = "bullet";
  /// Bullet counts the nodes, of which it reserves twice as many as there are triangles, by an int.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 30) - 1;

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
  static constexpr std::string_view name = "bullet_quantized";
  /// While it builds, Bullet counts the bytes of the tree, 16 a node, by an int. The 21 bits that
  /// it has for the number of a triangle are no limit: the mesh is handed over in parts.
  static constexpr std::size_t most_triangles = std::size_t{1} << 26;

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
