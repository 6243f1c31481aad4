// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// Every index is held to brute force: the same triangles, whatever the place and the radius.
#include "adapters/index_contract.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <string>

#include "keepout/adapters/all_indices.h"
#include "keepout/error.h"
#include "keepout/fixtures/shapes.h"

namespace keepout {
namespace {

class IndexContract : public testing::TestWithParam<IndexBackend> {};

TEST_P(IndexContract, FindsWhatBruteForceFindsOnEveryGeneratedShape) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = std::make_shared<const Mesh>(shape.make());
    expect_brute_force_sets(mesh, *GetParam().make(mesh), 20);
    if (HasFatalFailure()) return;
  }
}

TEST_P(IndexContract, FindsWhatBruteForceFindsOnOneTriangleAndOnManyInOnePlace) {
  const Surface one{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}};
  Surface many = one;
  many.triangles.assign(100, {0, 1, 2});
  Surface points{{Vec3(1, 2, 3)}, {{0, 0, 0}, {0, 0, 0}}};
  for (const Surface& surface : {one, many, points}) {
    const auto mesh = std::make_shared<const Mesh>(surface);
    const auto index = GetParam().make(mesh);
    HitBuffer hits(mesh->triangle_count());
    TriangleBuffer candidates(mesh->triangle_count());
    const Vec3 corner = mesh->vertex(0);
    index->collect({corner, 0.0}, candidates);
    refine(*mesh, {corner, 0.0}, candidates.view(), hits);
    EXPECT_EQ(hits.size(), mesh->triangle_count());
    candidates.clear();
    hits.clear();
    index->collect({corner + Vec3(0, 0, 5), 4.999}, candidates);
    refine(*mesh, {corner + Vec3(0, 0, 5), 4.999}, candidates.view(), hits);
    EXPECT_TRUE(hits.empty());
  }
}

TEST_P(IndexContract, NeverGivesATriangleTwice) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("star_bumps"));
  const auto index = GetParam().make(mesh);
  TriangleBuffer candidates(mesh->triangle_count());
  index->collect({mesh->bounds().center(), mesh->bounds().size().norm()}, candidates);
  ASSERT_EQ(candidates.size(), mesh->triangle_count());
  std::sort(candidates.begin(), candidates.end());
  EXPECT_EQ(std::adjacent_find(candidates.begin(), candidates.end()), candidates.end());
}

TEST_P(IndexContract, ManyThreadsMayAskAtOnce) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("star_bumps"));
  const auto index = GetParam().make(mesh);
  const auto found = [&](std::uint64_t seed) {
    TriangleBuffer candidates(mesh->triangle_count());
    Random random(seed);
    std::vector<TriangleId> all;
    for (const Vec3& point : surface_points(*mesh, 50, 1.0, random)) {
      candidates.clear();
      index->collect({point, 5.0}, candidates);
      all.insert(all.end(), candidates.begin(), candidates.end());
    }
    return all;
  };
  std::vector<std::future<std::vector<TriangleId>>> answers;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    answers.push_back(std::async(std::launch::async, found, seed));
  }
  for (std::uint64_t seed = 0; seed < 4; ++seed) EXPECT_EQ(answers[seed].get(), found(seed));
}

TEST_P(IndexContract, SaysWhenTheBufferIsTooSmall) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cube"));
  TriangleBuffer candidates(3);
  GetParam().make(mesh)->collect({mesh->bounds().center(), 1e3}, candidates);
  EXPECT_TRUE(candidates.overflowed());
}

std::string backend_name(const testing::TestParamInfo<IndexBackend>& info) {
  return std::string(info.param.name);
}

INSTANTIATE_TEST_SUITE_P(Backends, IndexContract, testing::ValuesIn(all_index_backends()),
                         backend_name);

TEST(IndexRegistry, AnUnknownNameListsTheKnownOnes) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cube"));
  try {
    make_index("pd-tree", mesh);
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("pd-tree"), std::string::npos);
    for (const IndexBackend& backend : index_backends()) {
      EXPECT_NE(text.find(backend.name), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace keepout
