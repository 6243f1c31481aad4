// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The same triangles in the same order, and the same work, whatever processor answers: each kind
// that this one can stand in for is held to one lane at a time.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <bit>
#include <cstring>
#include <vector>

#include "engine/index/exact_index.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "only_target.h"

namespace keepout {
namespace {

/// All that this processor can do and the engine is compiled for, the plainest first.
std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> all;
  for (std::uint64_t rest = static_cast<std::uint64_t>(hwy::SupportedTargets() & HWY_TARGETS);
       rest != 0;) {
    const std::uint64_t highest = std::bit_floor(rest);
    all.push_back(static_cast<std::int64_t>(highest));
    rest &= ~highest;
  }
  return all;
}

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
  QueryCounts counts;
};

template <class Index>
Answers answers(const Index& index, const std::vector<Ball>& balls) {
  TriangleBuffer found(index.mesh().triangle_count());
  Answers all;
  for (const Ball& ball : balls) {
    found.clear();
    index.collect(ball, found, all.counts);
    all.found.emplace_back(found.begin(), found.end());
    found.clear();
    index.collect(ball, found);
    EXPECT_TRUE(
        std::equal(found.begin(), found.end(), all.found.back().begin(), all.found.back().end()))
        << "counting changes the answer";
  }
  return all;
}

template <class Index>
class IndexLanes : public testing::Test {};

using Indices = testing::Types<WideBvh, PdTree>;
TYPED_TEST_SUITE(IndexLanes, Indices);

TYPED_TEST(IndexLanes, EveryProcessorGivesTheSameTrianglesInTheSameOrder) {
  ASSERT_GE(targets().size(), 2u);
  for (const char* name : {"cortex", "gear", "needles", "triangle_soup"}) {
    SCOPED_TRACE(name);
    const TypeParam index(std::make_shared<const Mesh>(make_shape(name)));
    const std::vector<Ball> asked = balls(index.mesh());
    Answers expected;
    for (const std::int64_t target : targets()) {
      SCOPED_TRACE(hwy::TargetName(target));
      const OnlyTarget only(target);
      Answers got = answers(index, asked);
      if (target == targets().front()) {
        EXPECT_GT(got.counts.triangles, 0u) << "the kernel was never asked";
        expected = std::move(got);
        continue;
      }
      EXPECT_EQ(got.found, expected.found);
      EXPECT_EQ(got.counts.nodes, expected.counts.nodes);
      EXPECT_EQ(got.counts.blocks, expected.counts.blocks);
      EXPECT_EQ(got.counts.triangles, expected.counts.triangles);
    }
  }
}

TYPED_TEST(IndexLanes, EveryProcessorBuildsTheSameTree) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  const TypeParam expected(mesh);
  for (const std::int64_t target : targets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const OnlyTarget only(target);
    const TypeParam index(mesh);
    ASSERT_EQ(index.nodes().size_bytes(), expected.nodes().size_bytes());
    EXPECT_EQ(
        std::memcmp(index.nodes().data(), expected.nodes().data(), expected.nodes().size_bytes()),
        0);
    ASSERT_EQ(index.leaves().size_bytes(), expected.leaves().size_bytes());
    EXPECT_EQ(std::memcmp(index.leaves().data(), expected.leaves().data(),
                          expected.leaves().size_bytes()),
              0);
  }
}

TEST(WideBvhLanes, CylindersHoldWhateverProcessorBuildsThem) {
  for (const char* name : {"cortex", "needles", "far_cube"}) {
    const auto mesh = shared_shape(name);
    for (const std::int64_t target : targets()) {
      SCOPED_TRACE(testing::Message() << name << " on " << hwy::TargetName(target));
      const OnlyTarget only(target);
      expect_cylinders_hold(WideBvh(mesh));
    }
  }
}

}  // namespace
}  // namespace keepout
