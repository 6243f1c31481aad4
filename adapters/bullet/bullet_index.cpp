// SPDX-License-Identifier: BSD-3-Clause
#include <BulletCollision/CollisionShapes/btOptimizedBvh.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "../src/centered_frame.h"
#include "../src/index_module.h"
#include "keepout/error.h"
#include "keepout/geometry/shapes.h"
#include "keepout/mesh/mesh.h"

// Debian has Bullet in both precisions. Headers for one also link with the library of the other.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");

namespace keepout {
namespace {

/// The mesh in the form for Bullet's build of a tree: in a centered frame, without a copy. It is in
/// parts of at most as many triangles as a quantized node can number.
class BulletMesh final : public btStridingMeshInterface {
 public:
  static constexpr int bits_in_part = 31 - MAX_NUM_PARTS_IN_BITS;

  BulletMesh(const Mesh& mesh, const CenteredFrame& frame) : mesh_(mesh), frame_(frame) {}

  static btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

  /// Returns the triangle from Bullet's part and the number in the part.
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

  // A tree never calls the functions below; other users of such a mesh do.
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
  [[noreturn]] static void refuse() {
    throw Error("this version of Bullet needs a copy of the mesh");
  }

  const Mesh& mesh_;
  const CenteredFrame& frame_;
};

// Bullet's trees, made accessible for a traversal by this file. Both are arrays of nodes. A parent
// comes before its children and has the size of its subtree, so a traversal can skip it.

Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

/// Nodes of 96 bytes: a box in double, the size of the subtree, the triangle.
class BulletTree final : public btOptimizedBvh {
 public:
  static constexpr std::string_view name = "bullet";
  /// Bullet counts nodes by an int, and reserves two for each triangle.
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
  /// Bullet counts the bytes of the tree by an int during a build, 16 for each node. The 21 bits
  /// for a triangle's number are no limit, because the mesh is passed in parts.
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

  Vec3 origin_;  // of the quantized coordinates
  Vec3 step_;    // of one quantum
};

/// A tree of Bullet over a mesh, verified to contain the mesh. Derived classes traverse it. The
/// mesh may be deleted after the build.
template <class Tree>
class BulletModel : public SpatialIndex {
 public:
  static constexpr std::string_view name = Tree::name;
  static constexpr std::size_t most_triangles = Tree::most_triangles;

  explicit BulletModel(std::shared_ptr<const Mesh> mesh)
      : SpatialIndex(std::move(mesh)),
        frame_(this->mesh().bounds(), reach_of_frame),
        bounds_(frame_.from_mesh(this->mesh().bounds())),
        tree_(tree_of(this->mesh(), frame_)) {
    check(this->mesh());
  }

  std::size_t memory() const noexcept override { return tree_.memory(); }

 protected:
  const Tree& tree() const noexcept { return tree_; }

  /// Returns the ball in the frame of the tree, grown by the rounding of boxes and of the exact
  /// kernel.
  Ball padded(const Ball& ball) const noexcept {
    const Vec3 center = frame_.from_mesh(ball.center);
    return {center, padded_radius({center, frame_.from_mesh(ball.radius)}, bounds_)};
  }

 private:
  // In the frame of the trees. Bullet widens a quantized mesh by 1, and thin triangles by 0.001,
  // for any size of the mesh. With 2^16 steps across, both are at most one step.
  static constexpr double reach_of_frame = 0x1p15;

  static Tree tree_of(const Mesh& mesh, const CenteredFrame& frame) {
    BulletMesh for_bullet(mesh, frame);
    return Tree(for_bullet);
  }

  /// Bullet asserts its limits only in debug builds, and confuses triangles beyond them. So this
  /// checks that each triangle is there once, within the boxes of all nodes above it.
  void check(const Mesh& mesh) const {
    struct Subtree {
      int end;
      Box box;
    };
    std::vector<Subtree> above;
    std::vector<char> found(mesh.triangle_count(), 0);
    for (int n = 0; n < tree_.node_count(); ++n) {
      while (!above.empty() && above.back().end == n) above.pop_back();
      const Box box = tree_.box(n);
      if (!above.empty() && !holds(above.back().box, box)) fail();
      if (!tree_.is_leaf(n)) {
        above.push_back({n + tree_.subtree_size(n), box});
        continue;
      }
      const TriangleId t = tree_.triangle(n);
      if (t >= found.size() || found[t] != 0) fail();
      found[t] = 1;
      for (const Vec3& corner : mesh.triangle(t)) {
        const Vec3 local = frame_.from_mesh(corner);
        if (!holds(box, {local, local})) fail();
      }
    }
    if (std::find(found.begin(), found.end(), 0) != found.end()) fail();
  }

  /// Allows a tenth of the rounding by which the radius is padded.
  bool holds(const Box& outer, const Box& inner) const {
    const double slack = 0.1 * padded_radius({bounds_.center(), 0.0}, bounds_);
    return ((inner.low - outer.low).array() >= -slack).all() &&
           ((outer.high - inner.high).array() >= -slack).all();
  }

  [[noreturn]] static void fail() {
    throw Error("Bullet's tree does not contain the mesh; use the index 'pd_tree'");
  }

  CenteredFrame frame_;
  Box bounds_;  // of the mesh, in the frame
  Tree tree_;
};

/// Bullet's tree, traversed here: Bullet's own traversal takes a box, not a ball.
template <class Tree>
class BulletIndex final : public BulletModel<Tree> {
 public:
  using BulletModel<Tree>::BulletModel;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const Ball padded = this->padded(ball);
    const Tree& tree = this->tree();
    for (int n = 0; n < tree.node_count() && !candidates.overflowed();) {
      if (squared_distance(tree.box(n), padded.center) > padded.radius * padded.radius) {
        n += tree.subtree_size(n);
        continue;
      }
      if (tree.is_leaf(n)) candidates.push(tree.triangle(n));
      ++n;
    }
  }
};

/// Bullet's tree, traversed by Bullet.
class BulletCallbackIndex final : public BulletModel<BulletQuantizedTree> {
 public:
  static constexpr std::string_view name = "bullet_callback";

  using BulletModel<BulletQuantizedTree>::BulletModel;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const Ball box = padded(ball);
    const Vec3 reach = Vec3::Constant(box.radius);
    Collector collector(candidates);
    tree().reportAabbOverlappingNodex(&collector, BulletMesh::bullet(box.center - reach),
                                      BulletMesh::bullet(box.center + reach));
  }

 private:
  class Collector final : public btNodeOverlapCallback {
   public:
    explicit Collector(TriangleBuffer& candidates) : candidates_(candidates) {}
    void processNode(int part, int number) override {
      candidates_.push(BulletMesh::triangle(part, number));
    }

   private:
    TriangleBuffer& candidates_;
  };
};

template <class Index>
std::unique_ptr<SpatialIndex> make(std::shared_ptr<const Mesh> mesh) {
  require_at_most(Index::most_triangles, mesh->triangle_count(), "triangles", Index::name);
  return std::make_unique<Index>(std::move(mesh));
}

std::string library() {
  return "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
         std::to_string(BT_BULLET_VERSION % 100);
}

constexpr IndexBackend backends[] = {
    {BulletQuantizedTree::name, "axis-aligned boxes of Bullet, in 16 bits",
     make<BulletIndex<BulletQuantizedTree>>, BulletQuantizedTree::most_triangles, library},
    {BulletTree::name, "axis-aligned boxes of Bullet", make<BulletIndex<BulletTree>>,
     BulletTree::most_triangles, library},
    {BulletCallbackIndex::name,
     "axis-aligned boxes of Bullet, in 16 bits, by its own traversal and callback",
     make<BulletCallbackIndex>, BulletCallbackIndex::most_triangles, library, Allocation::never,
     "Bullet's traversal takes a box, not a ball, and so finds more candidates; it calls back for "
     "each, "
     "without fetching the triangle's corners as processAllTriangles() would."},
};

}  // namespace

}  // namespace keepout

const std::span<const keepout::IndexBackend> keepout_indices = keepout::backends;
