// SPDX-License-Identifier: BSD-3-Clause
// Tests both trees. A query returns exactly the triangles that touch a ball, for little work.
// Triangles, leaves, their order, trees and work are the same on every SIMD target of this
// processor, down to one lane at a time.

#include <cstring>
#include <optional>
#include <set>
#include <type_traits>

#include "engine/index/exact_index.h"
#include "index/pd_tree/tree.h"
#include "meshes.h"

namespace keepout {
namespace {

std::vector<Ball> balls(const Mesh& mesh) {
  const double size = mesh.bounds().size().norm();
  Random random(8);
  std::vector<Ball> all;
  for (const double offset : {0.0, 1e-3 * size}) {
    for (const Vec3& point : surface_points(mesh, 40, offset, random)) {
      for (const double radius : {0.0, 1e-3, 1e-2, 0.05, 0.3}) {
        all.push_back({point, radius * size});
      }
    }
  }
  for (const Vec3& point : vertex_points(mesh, 20, random)) all.push_back({point, 0.0});
  return all;
}

struct Answers {
  std::vector<std::vector<TriangleId>> found;
  std::vector<std::vector<std::uint32_t>> leaves;
  QueryCounts counts;
};

template <class Index>
Answers answers(const Index& index, const std::vector<Ball>& balls) {
  TriangleBuffer found(index.mesh().triangle_count());
  LeafBuffer leaves(index.tree().leaves().size());
  Answers all;
  for (const Ball& ball : balls) {
    found.clear();
    index.collect(ball, found, &all.counts);
    all.found.emplace_back(found.begin(), found.end());
    found.clear();
    index.collect(ball, found);
    EXPECT_TRUE(
        std::equal(found.begin(), found.end(), all.found.back().begin(), all.found.back().end()))
        << "counting changes the answer";
    leaves.clear();
    index.tree().collect_leaves(ball, leaves);
    all.leaves.emplace_back(leaves.begin(), leaves.end());
  }
  return all;
}

template <class Index>
class TreeIndex : public testing::Test {};

using Indices = testing::Types<WideBvh, PdTree>;
TYPED_TEST_SUITE(TreeIndex, Indices);

TYPED_TEST(TreeIndex, GivesTheTrianglesThatTouchTheBallAndNoOthers) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    expect_exact(*mesh, TypeParam(mesh), 10);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(TreeIndex, IsExactWhereverTheMeshIsAndHoweverLarge) {
  for (const double scale : {1e-30, 1e-12, 1e-6, 1.0, 1e6, 1e16, 1e22}) {
    for (const double offset : {0.0, 10.0, 1e6}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " offset " << offset);
      const auto mesh = moved(*mesh_of("gear"), [&](const Vec3& v) -> Vec3 {
        return scale * (v + offset * Vec3(1.0, -0.7, 0.3));
      });
      expect_exact(*mesh, TypeParam(mesh), 3);
      if (this->HasFatalFailure()) return;
    }
  }
}

TYPED_TEST(TreeIndex, IsExactForEveryNumberOfTrianglesAboutFullLeavesAndAFullTree) {
  for (const std::size_t count :
       {1u, 2u, 15u, 16u, 17u, 33u, 255u, 256u, 257u, 4095u, 4096u, 4097u}) {
    SCOPED_TRACE(count);
    const auto mesh = beginning_of("cortex", count);
    const TypeParam index(mesh);
    expect_leaves_hold(*mesh, index.tree());
    expect_exact(*mesh, index, 2);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(TreeIndex, IsExactWhereTrianglesAreInOnePlaneOrAllAlike) {
  const auto flat = moved(*mesh_of("cortex"), [](const Vec3& v) -> Vec3 {
    return {v.x(), v.y(), 3.0};
  });
  expect_exact(*flat, TypeParam(flat), 5);
  Surface alike{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {}};
  alike.triangles.assign(3000, {0, 1, 2});
  const auto mesh = mesh_of(alike);
  expect_exact(*mesh, TypeParam(mesh), 5);
}

TYPED_TEST(TreeIndex, HoldsNothingInABallThatIsNoNumber) {
  const auto mesh = mesh_of("cube");
  const TypeParam index(mesh);
  TriangleBuffer found(mesh->triangle_count());
  index.collect({Vec3::Constant(std::nan("")), 1.0}, found);
  index.collect({Vec3::Zero(), std::nan("")}, found);
  EXPECT_TRUE(found.empty());
}

// The limits are slightly above the measured values, to detect a worse tree or a weaker filter.
TYPED_TEST(TreeIndex, ExaminesNoMoreThanItDidInFewBytes) {
  constexpr bool is_wide = std::is_same_v<TypeParam, WideBvh>;
  const auto mesh = mesh_of(make_cortex(0.7, 1));
  const TypeParam index(mesh);
  TriangleBuffer found(mesh->triangle_count());
  Random random(4);
  QueryCounts counts;
  std::size_t triangles = 0;
  for (const Vec3& point : surface_points(*mesh, 1000, 0.5, random)) {
    found.clear();
    index.collect({point, 5.0}, found, &counts);
    triangles += found.size();
  }
  EXPECT_EQ(triangles, 251'838u);
  EXPECT_LE(counts.nodes, is_wide ? 10'500u : 135'000u);
  EXPECT_LE(counts.blocks, is_wide ? 28'000u : 26'000u);
  EXPECT_LE(counts.triangles, 10u);
  EXPECT_LT(index.memory(), (is_wide ? 45u : 52u) * mesh->triangle_count());
}

TYPED_TEST(TreeIndex, TheLeavesOfABallHoldAllTrianglesThatTouchIt) {
  const TypeParam index(mesh_of("cortex"));
  std::vector<std::uint32_t> leaf_of(index.mesh().triangle_count());
  for (std::uint32_t leaf = 0; leaf < index.tree().leaves().size(); ++leaf) {
    const LeafBlock& block = index.tree().leaves()[leaf];
    for (std::size_t lane = 0; lane < LeafBlock::lanes && block.is_used(lane); ++lane) {
      leaf_of[block.triangle(lane)] = leaf;
    }
  }
  const std::vector<Ball> asked = balls(index.mesh());
  const Answers got = answers(index, asked);
  std::size_t listed = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const std::set<std::uint32_t> leaves(got.leaves[i].begin(), got.leaves[i].end());
    EXPECT_EQ(leaves.size(), got.leaves[i].size()) << "a leaf is listed twice";
    for (const TriangleId t : got.found[i]) EXPECT_TRUE(leaves.contains(leaf_of[t]));
    listed += leaves.size();
  }
  EXPECT_GT(listed, asked.size());
  EXPECT_LT(listed, asked.size() * index.tree().leaves().size() / 2) << "most are out of reach";
}

TYPED_TEST(TreeIndex, ABallBeyondWhatFloatsCanTellHasAllLeaves) {
  const TypeParam index(mesh_of("cortex"));
  LeafBuffer leaves(index.tree().leaves().size());
  index.tree().collect_leaves({Vec3::Zero(), 1e20}, leaves);
  EXPECT_EQ(leaves.size(), index.tree().leaves().size());
  EXPECT_FALSE(leaves.overflowed());
}

TYPED_TEST(TreeIndex, EveryProcessorGivesTheSameTrianglesInTheSameOrder) {
  ASSERT_GE(simd_targets().size(), 2u);
  for (const char* name : {"cortex", "gear", "needles", "triangle_soup"}) {
    SCOPED_TRACE(name);
    const TypeParam index(mesh_of(name));
    const std::vector<Ball> asked = balls(index.mesh());
    std::optional<Answers> expected;
    on_each_simd_target([&] {
      const Answers got = answers(index, asked);
      if (!expected) expected = got;
      EXPECT_GT(got.counts.triangles, 0u) << "the kernel was never asked";
      EXPECT_EQ(got.found, expected->found);
      EXPECT_EQ(got.leaves, expected->leaves);
      EXPECT_EQ(got.counts.nodes, expected->counts.nodes);
      EXPECT_EQ(got.counts.blocks, expected->counts.blocks);
      EXPECT_EQ(got.counts.triangles, expected->counts.triangles);
    });
  }
}

template <class Block>
void expect_same_blocks(std::span<const Block> got, std::span<const Block> expected) {
  ASSERT_EQ(got.size_bytes(), expected.size_bytes());
  EXPECT_EQ(std::memcmp(got.data(), expected.data(), expected.size_bytes()), 0);
}

TYPED_TEST(TreeIndex, EveryProcessorBuildsTheSameTree) {
  const auto mesh = mesh_of("cortex");
  const TypeParam expected(mesh);
  on_each_simd_target([&] {
    const TypeParam index(mesh);
    expect_same_blocks(index.tree().nodes(), expected.tree().nodes());
    expect_same_blocks(index.tree().leaves(), expected.tree().leaves());
  });
}

/// Tests coordinates that are floats and coordinates that are not.
TEST(WideBvhLanes, EveryProcessorRefitsToTheSameTree) {
  for (const double stretch : {2.0, 1.1}) {
    Surface surface = as_floats(make_shape("cortex"));
    const auto before = mesh_of(surface);
    for (Vec3& v : surface.vertices) v.z() *= stretch;
    const auto after = mesh_of(surface);
    WideBvh expected(before);
    expected.refit(after);
    EXPECT_EQ(expected.tree().frame().is_exact(), stretch == 2.0);
    on_each_simd_target([&] {
      WideBvh index(before);
      index.refit(after);
      expect_same_blocks(index.tree().nodes(), expected.tree().nodes());
      expect_same_blocks(index.tree().leaves(), expected.tree().leaves());
      EXPECT_EQ(index.tree().frame().error, expected.tree().frame().error);
      EXPECT_EQ(index.tree().frame().origin, expected.tree().frame().origin);
      expect_cylinders_hold(index.tree());
    });
  }
}

TEST(WideBvhLanes, CylindersHoldWhateverProcessorBuildsThem) {
  for (const char* name : {"cortex", "needles", "far_cube"}) {
    SCOPED_TRACE(name);
    const auto mesh = mesh_of(name);
    on_each_simd_target([&] { expect_cylinders_hold(WideBvh(mesh).tree()); });
  }
}

}  // namespace
}  // namespace keepout
