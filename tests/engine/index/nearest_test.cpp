// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/nearest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "adapters/index_contract.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"

namespace keepout {
namespace {

TEST(NearestTriangle, IsTheOneThatBruteForceFindsAndTheLowestAmongEquals) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = std::make_shared<const Mesh>(shape.make());
    const PdTree tree(mesh);
    NearestTriangle nearest(*mesh, tree);
    for (const Vec3& point : probing_points(*mesh, 10)) {
      const std::vector<double> distance = distances(*mesh, point);
      const auto expected = std::min_element(distance.begin(), distance.end());
      for (const double guess : {0.0, 0.5 * *expected, *expected, 3.0 * *expected}) {
        const Hit hit = nearest(point, guess);
        ASSERT_EQ(hit.triangle, expected - distance.begin());
        ASSERT_EQ(hit.closest.distance, *expected);
      }
    }
  }
}

TEST(NearestTriangle, GrowsItsMemoryWhenABallHoldsTheWholeMesh) {
  const auto mesh = std::make_shared<const Mesh>(make_sphere(2.0));
  ASSERT_GT(mesh->triangle_count(), 5000u);
  const BruteForce brute(mesh);
  NearestTriangle nearest(*mesh, brute);
  EXPECT_NEAR(nearest(Vec3::Zero(), 1000.0).closest.distance, 50.0, 0.1);
}

}  // namespace
}  // namespace keepout
