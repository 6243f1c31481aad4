// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/pd_tree.h"

#include <gtest/gtest.h>

#include <cstring>

#include "engine/index/exact_index.h"
#include "index/pd_tree/tree.h"

namespace keepout {
namespace {

/// Fails unless the boxes of the subtree hold their triangles, and have directions that are
/// orthonormal to the rounding of floats.
void expect_boxes_hold(const PdTree::Tree& tree, std::size_t self, std::size_t first_leaf) {
  const PdNode& node = tree.nodes()[self];
  Eigen::Matrix3d axes;
  Vec3 center, half;
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = node.center[axis];
    half[axis] = node.half[axis];
    for (int k = 0; k < 3; ++k) axes(k, axis) = node.across[axis][k];
  }
  ASSERT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 3e-7);
  for (const LeafBlock& leaf : tree.leaves().subspan(first_leaf, node.leaves)) {
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      for (const Vec3& corner : tree.mesh().triangle(leaf.triangle(lane))) {
        const Vec3 along = axes * (corner - tree.frame().origin - center);
        ASSERT_TRUE((along.cwiseAbs().array() <= half.array()).all());
      }
    }
  }
  if (node.leaves == 1) return;
  const std::size_t near = node.leaves / 2;
  ASSERT_EQ(tree.nodes()[self + 1].leaves, near);
  ASSERT_EQ(tree.nodes()[self + 2 * near].leaves, node.leaves - near);
  expect_boxes_hold(tree, self + 1, first_leaf);
  expect_boxes_hold(tree, self + 2 * near, first_leaf + near);
}

TEST(PdTree, BoxesHoldTheirTriangles) {
  for (const char* name : {"cortex", "needles", "far_cube", "fan", "flat_plate"}) {
    SCOPED_TRACE(name);
    const PdTree index(mesh_of(name));
    const PdTree::Tree& tree = index.tree();
    ASSERT_EQ(tree.nodes().size(), 2 * tree.leaves().size() - 1);
    ASSERT_EQ(tree.nodes()[0].leaves, tree.leaves().size());
    expect_boxes_hold(tree, 0, 0);
    if (HasFatalFailure()) return;
  }
}

TEST(PdTree, IsTheSameTreeWhateverTheNumberOfThreads) {
  const auto mesh = mesh_of(make_cortex(0.7, 1));
  const PdTree built_alone(mesh, 1);
  const PdTree::Tree& alone = built_alone.tree();
  for (const unsigned threads : {2u, 3u, 8u}) {
    const PdTree index(mesh, threads);
    const PdTree::Tree& tree = index.tree();
    ASSERT_EQ(tree.nodes().size(), alone.nodes().size());
    EXPECT_EQ(std::memcmp(tree.nodes().data(), alone.nodes().data(), alone.nodes().size_bytes()),
              0);
    EXPECT_EQ(std::memcmp(tree.leaves().data(), alone.leaves().data(), alone.leaves().size_bytes()),
              0);
  }
}

}  // namespace
}  // namespace keepout
