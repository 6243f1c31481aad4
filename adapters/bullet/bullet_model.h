// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "../src/centered_frame.h"
#include "bullet_mesh.h"
#include "bullet_trees.h"
#include "keepout/error.h"
#include "keepout/geometry/ball_against_box.h"

namespace keepout {

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

}  // namespace keepout
