// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/pd_tree_1997.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "meshes.h"

namespace keepout {
namespace {

std::vector<TriangleId> sorted_candidates(const SpatialIndex& index, const Ball& ball,
                                          std::size_t room) {
  TriangleBuffer candidates(room);
  index.collect(ball, candidates);
  std::sort(candidates.begin(), candidates.end());
  return {candidates.begin(), candidates.end()};
}

/// Triangles at both sides of the origin, each 40 times as near as the one before: at the mean,
/// each split takes one triangle off.
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
