// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bullet_index.h"

#include "../src/capacity.h"
#include "bullet_model.h"

namespace keepout {
namespace {

/// Bullet's tree, walked by us: its own walk takes a box, not a ball.
template <class Tree>
class BulletIndex final : public SpatialIndex {
 public:
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

}  // namespace

// Of the one form that the registry knows; once built, a tree needs the mesh no more.
// NOLINTBEGIN(performance-unnecessary-value-param)
std::unique_ptr<SpatialIndex> make_bullet_index(std::shared_ptr<const Mesh> mesh) {
  require_at_most(bullet_most_triangles, mesh->triangle_count(), "triangles", "bullet");
  return std::make_unique<BulletIndex<BulletTree>>(*mesh);
}

std::unique_ptr<SpatialIndex> make_bullet_quantized_index(std::shared_ptr<const Mesh> mesh) {
  require_at_most(bullet_quantized_most_triangles, mesh->triangle_count(), "triangles",
                  "bullet_quantized");
  return std::make_unique<BulletIndex<BulletQuantizedTree>>(*mesh);
}

std::unique_ptr<SpatialIndex> make_bullet_callback_index(std::shared_ptr<const Mesh> mesh) {
  require_at_most(bullet_quantized_most_triangles, mesh->triangle_count(), "triangles",
                  "bullet_callback");
  return std::make_unique<BulletCallbackIndex>(*mesh);
}
// NOLINTEND

std::string bullet_library() {
  return "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
         std::to_string(BT_BULLET_VERSION % 100);
}

}  // namespace keepout
