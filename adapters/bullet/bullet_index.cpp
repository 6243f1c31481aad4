// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <vector>

#include "../src/library_backends.h"
#include "bullet_trees.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

/// A tree of Bullet's over a mesh, known to hold it. The mesh may go once it is built.
template <class Tree>
class BulletModel {
 public:
  explicit BulletModel(const Mesh& mesh)
      : frame_(mesh.bounds(), reach_of_frame),
        bounds_(frame_.from_mesh(mesh.bounds())),
        tree_(tree_of(mesh, frame_)) {
    check(mesh);
  }

  const Tree& tree() const noexcept { return tree_; }

  /// In the frame of the tree: the ball, as much larger as boxes and the exact kernel may round.
  Ball padded(const Ball& ball) const noexcept {
    const Vec3 center = frame_.from_mesh(ball.center);
    return {center, padded_radius({center, frame_.from_mesh(ball.radius)}, bounds_)};
  }

 private:
  // In the frame of the trees. Bullet widens a quantised mesh by 1, and thin triangles by 0.001,
  // whatever their size: with 2^16 steps across, both are no more than a step.
  static constexpr double reach_of_frame = 0x1p15;

  static Tree tree_of(const Mesh& mesh, const CenteredFrame& frame) {
    BulletMesh for_bullet(mesh, frame);
    return Tree(for_bullet);
  }

  /// Bullet asserts its limits in debug builds only, and beyond them confuses triangles. So
  /// each must be there once, within the boxes of all nodes above it.
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

  /// To a tenth of the rounding that the radius is padded by.
  bool holds(const Box& outer, const Box& inner) const {
    const double slack = 0.1 * padded_radius({bounds_.center(), 0.0}, bounds_);
    return ((inner.low - outer.low).array() >= -slack).all() &&
           ((outer.high - inner.high).array() >= -slack).all();
  }

  [[noreturn]] static void fail() {
    throw Error("Bullet's tree does not hold the mesh; use the index 'pd_tree'");
  }

  CenteredFrame frame_;
  Box bounds_;  // of the mesh, in the frame
  Tree tree_;
};

/// Bullet's tree, walked by us: its own walk takes a box, not a ball.
template <class Tree>
class BulletIndex final : public SpatialIndex {
 public:
  static constexpr std::string_view name = Tree::name;
  static constexpr std::size_t most_triangles = Tree::most_triangles;

  explicit BulletIndex(const Mesh& mesh) : model_(mesh) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const Ball padded = model_.padded(ball);
    const Tree& tree = model_.tree();
    for (int n = 0; n < tree.node_count();) {
      if (squared_distance(tree.box(n), padded.center) > padded.radius * padded.radius) {
        n += tree.subtree_size(n);
        continue;
      }
      if (tree.is_leaf(n)) candidates.push(tree.triangle(n));
      ++n;
    }
  }

  std::size_t memory() const noexcept override { return model_.tree().memory(); }

 private:
  BulletModel<Tree> model_;
};

/// Bullet's tree, walked by Bullet.
class BulletCallbackIndex final : public SpatialIndex {
 public:
  static constexpr std::string_view name = "bullet_callback";
  static constexpr std::size_t most_triangles = BulletQuantizedTree::most_triangles;

  explicit BulletCallbackIndex(const Mesh& mesh) : model_(mesh) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const Ball padded = model_.padded(ball);
    const Vec3 reach = Vec3::Constant(padded.radius);
    Collector collector(candidates);
    model_.tree().reportAabbOverlappingNodex(&collector, BulletMesh::bullet(padded.center - reach),
                                             BulletMesh::bullet(padded.center + reach));
  }

  std::size_t memory() const noexcept override { return model_.tree().memory(); }

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

  BulletModel<BulletQuantizedTree> model_;
};

template <class Index>
std::unique_ptr<SpatialIndex> make(std::shared_ptr<const Mesh> mesh) {
  require_at_most(Index::most_triangles, mesh->triangle_count(), "triangles", Index::name);
  return std::make_unique<Index>(*mesh);
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
     "axis-aligned boxes of Bullet, in 16 bits, by its own walk and callback",
     make<BulletCallbackIndex>, BulletCallbackIndex::most_triangles, library, Allocation::never,
     "Bullet's walk takes a box, not a ball, and so finds more candidates; it calls back for each, "
     "without fetching the triangle's corners as processAllTriangles() would."},
};

}  // namespace

std::span<const IndexBackend> bullet_indices() noexcept { return backends; }

}  // namespace keepout
