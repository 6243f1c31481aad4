// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bullet_index.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/geometry/ball_against_box.h"
#include "../src/capacity.h"
#include "../src/centered_frame.h"
#include "bullet_mesh.h"
#include "bullet_trees.h"
#include "keepout/error.h"

namespace keepout {
namespace {

// In the frame of the trees. Bullet widens a quantised mesh by 1, and thin triangles by 0.001,
// whatever their size: with 2^16 steps across, both are no more than a step.
constexpr double reach_of_frame = 0x1p15;

/// Bullet's tree, walked by us: its own walk takes a box, not a ball.
template <class Tree>
class BulletIndex final : public SpatialIndex {
 public:
  BulletIndex(const Mesh& mesh, const CenteredFrame& frame)
      : frame_(frame), bounds_(frame.from_mesh(mesh.bounds())), tree_(tree_of(mesh, frame)) {
    check(mesh);
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const Vec3 center = frame_.from_mesh(ball.center);
    const double reach = padded_radius({center, frame_.from_mesh(ball.radius)}, bounds_);
    for (int n = 0; n < tree_.node_count();) {
      if (squared_distance(tree_.box(n), center) > reach * reach) {
        n += tree_.subtree_size(n);
        continue;
      }
      if (tree_.is_leaf(n)) candidates.push(tree_.triangle(n));
      ++n;
    }
  }

  std::size_t memory() const noexcept override { return tree_.memory(); }

 private:
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

template <class Tree>
std::unique_ptr<SpatialIndex> make(const Mesh& mesh, std::size_t most, std::string_view name) {
  require_at_most(most, mesh.triangle_count(), "triangles", name);
  return std::make_unique<BulletIndex<Tree>>(mesh, CenteredFrame(mesh.bounds(), reach_of_frame));
}

}  // namespace

// Of the one form that the registry knows; once built, a tree needs the mesh no more.
// NOLINTBEGIN(performance-unnecessary-value-param)
std::unique_ptr<SpatialIndex> make_bullet_index(std::shared_ptr<const Mesh> mesh) {
  return make<BulletTree>(*mesh, bullet_most_triangles, "bullet");
}

std::unique_ptr<SpatialIndex> make_bullet_quantized_index(std::shared_ptr<const Mesh> mesh) {
  return make<BulletQuantizedTree>(*mesh, bullet_quantized_most_triangles, "bullet_quantized");
}
// NOLINTEND(performance-unnecessary-value-param)

std::string bullet_library() {
  return "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
         std::to_string(BT_BULLET_VERSION % 100);
}

}  // namespace keepout
