// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/pd_tree.h"

#include <bit>
#include <cstring>

#include "engine/index/exact_index.h"
#include "index/pd_tree/tree.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree_1997.h"
#include "meshes.h"

namespace keepout {
namespace {

/// Fails unless the boxes of the subtree contain their triangles, and their axes are orthonormal up
/// to float rounding.
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

/// Returns the shape a thousand times smaller, and a triangle far away: the floats of the index
/// round the small triangles by much of their size.
Surface with_a_distant_triangle(Surface surface) {
  for (Vec3& vertex : surface.vertices) vertex = 1e-3 * vertex + Vec3(50.1, 20.3, 7.7);
  const auto first = static_cast<std::uint32_t>(surface.vertices.size());
  for (const Vec3& corner : {Vec3(-50, -20, -7), Vec3(-50, -21, -7), Vec3(-50, -20, -8)}) {
    surface.vertices.push_back(corner);
  }
  surface.triangles.push_back({first, first + 1, first + 2});
  return surface;
}

TEST(PdTree, BoxesHoldTheirTriangles) {
  for (const char* name : {"cortex", "needles", "far_cube", "fan", "flat_plate"}) {
    for (const Surface& surface : {make_shape(name), with_a_distant_triangle(make_shape(name))}) {
      SCOPED_TRACE(name);
      const PdTree index(std::make_shared<const Mesh>(surface));
      const PdTree::Tree& tree = index.tree();
      ASSERT_EQ(tree.nodes().size(), 2 * tree.leaves().size() - 1);
      ASSERT_EQ(tree.nodes()[0].leaves, tree.leaves().size());
      expect_boxes_hold(tree, 0, 0);
      if (HasFatalFailure()) return;
    }
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

std::vector<TriangleId> sorted_candidates(const SpatialIndex& index, const Ball& ball,
                                          std::size_t room) {
  TriangleBuffer candidates(room);
  index.collect(ball, candidates);
  std::sort(candidates.begin(), candidates.end());
  return {candidates.begin(), candidates.end()};
}

/// Returns triangles on both sides of the origin, each 40 times closer than the one before. A split
/// at the mean removes one triangle at a time.
std::shared_ptr<const Mesh> lopsided(int of_each_side) {
  Surface surface;
  for (int i = 0; i < of_each_side; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double at = side * std::pow(40.0, -i);
      const auto first = static_cast<VertexId>(surface.vertices.size());
      for (const Vec3& corner : {Vec3(1, 0, 0), Vec3(1, 0.1, 0), Vec3(1, 0, 0.1)}) {
        surface.vertices.push_back(at * corner);
      }
      surface.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return mesh_of(std::move(surface));
}

TEST(PdTree1997, AnswersWithTheTrianglesThatTouchTheBallAndNoOthers) {
  const auto mesh = mesh_of("star_bumps");
  const PdTree1997 tree(mesh);
  const BruteForce brute_force(mesh);
  EXPECT_TRUE(tree.is_exact());
  Random random(2);
  for (const Vec3& point : surface_points(*mesh, 20, 0.5, random)) {
    for (const double radius : {0.4, 2.0, 20.0}) {
      const std::size_t room = mesh->triangle_count();
      EXPECT_EQ(sorted_candidates(tree, {point, radius}, room),
                sorted_candidates(brute_force, {point, radius}, room));
    }
  }
}

TEST(PdTree1997, IsAsDeepAsABalancedTreeAndALittleMoreOnAnEvenMesh) {
  const auto mesh = mesh_of("cortex");
  const auto balanced =
      static_cast<std::size_t>(std::bit_width(mesh->triangle_count() / PdTree1997::leaf_triangles));
  const PdTree1997 tree(mesh);
  EXPECT_GE(tree.levels(), balanced);
  EXPECT_LE(tree.levels(), 2 * balanced);
}

TEST(PdTree1997, IsLopsidedWhereTheMeanIsAndHasABoundAllTheSame) {
  const auto mesh = lopsided(23);
  const auto balanced = static_cast<std::size_t>(std::bit_width(mesh->triangle_count()));
  const PdTree1997 tree(mesh);
  EXPECT_GT(tree.levels(), 2 * balanced) << "the mean takes off one triangle at a time";
  EXPECT_LE(tree.levels(), 3 * balanced);
  EXPECT_LE(tree.levels(), PdTree1997::most_levels);
  for (const double radius : {0.0, 1e-20, 1e-3, 2.0}) {
    const Ball ball{Vec3::Zero(), radius};
    EXPECT_EQ(sorted_candidates(tree, ball, mesh->triangle_count()),
              sorted_candidates(BruteForce(mesh), ball, mesh->triangle_count()));
  }
}

}  // namespace
}  // namespace keepout
