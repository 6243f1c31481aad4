// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/triangle_tree.h"

#include "keepout/fixtures/poses.h"
#include "keepout/oracle/distance.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

std::vector<TriangleId> sorted(std::vector<TriangleId> ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Returns points on the mesh, near it, and anywhere in its bounds.
std::vector<Vec3> places(const Mesh& mesh, Random& random) {
  std::vector<Vec3> all = random_points(mesh, test::trials(10u), random);
  for (const Vec3& p : vertex_points(mesh, test::trials(10u), random)) all.push_back(p);
  for (const Vec3& p : edge_points(mesh, test::trials(10u), random)) all.push_back(p);
  return all;
}

class TreeOfEveryShape : public testing::TestWithParam<Shape> {
 protected:
  std::shared_ptr<const Mesh> mesh = mesh_of(GetParam().make());
  TriangleTree tree{mesh};
  Random random{20261120};
  double size = mesh->bounds().size().norm();
};

TEST_P(TreeOfEveryShape, CollectsWhatAPlainLoopCollects) {
  for (const Vec3& place : places(*mesh, random)) {
    const Vec3 half = 0.1 * size * Vec3(random.uniform(), random.uniform(), random.uniform());
    for (const Bounds& box : {Bounds{place - half, place + half}, Bounds{place, place}}) {
      std::vector<TriangleId> expected, found;
      for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
        if (bounds_of(mesh->triangle(t)).overlaps(box)) expected.push_back(t);
      }
      tree.collect(box, found);
      ASSERT_EQ(sorted(found), expected);
    }
  }
}

TEST_P(TreeOfEveryShape, MissesNothingAlongASegment) {
  for (const Vec3& place : places(*mesh, random)) {
    const Segment segment{place, place + random.uniform() * size * random.direction()};
    std::vector<TriangleId> found;
    tree.collect_along(segment, found);
    found = sorted(found);
    ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
      if (bracket_distance(segment, mesh->triangle(t)).low > 0.0) continue;
      if (exact_distance(segment, mesh->triangle(t), 0.0).against_zero != 0) continue;
      ASSERT_TRUE(std::binary_search(found.begin(), found.end(), t)) << "triangle " << t;
    }
  }
}

TEST_P(TreeOfEveryShape, NearestIsWhatAPlainLoopFinds) {
  for (const Vec3& place : places(*mesh, random)) {
    double low = test::infinity;
    double estimate = low;
    for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
      const Bracket bracket = narrow_distance({place, place}, mesh->triangle(t));
      low = std::min(low, bracket.low);
      estimate = std::min(estimate, bracket.estimate);
    }
    const TriangleTree::Nearest nearest = tree.nearest(place, narrow_distance);
    ASSERT_EQ(nearest.distance.estimate, estimate);
    ASSERT_EQ(nearest.distance.low, low);
  }
}

INSTANTIATE_TEST_SUITE_P(TriangleTree, TreeOfEveryShape, testing::ValuesIn(shapes()), by_name);

TEST(TriangleTree, TakesTrianglesInOnePlaceAndAFewHugeOnesAmongTinyOnes) {
  Surface surface;
  surface.vertices = {{1, 2, 3}, {1e6, 0, 0}, {0, 1e6, 0}, {-1e6, -1e6, 1}};
  surface.triangles.assign(1000, {0, 0, 0});
  for (int i = 0; i < 5; ++i) surface.triangles.push_back({1, 2, 3});
  for (int i = 0; i < 1000; ++i) {
    const auto first = static_cast<VertexId>(surface.vertices.size());
    for (int k = 0; k < 3; ++k) surface.vertices.emplace_back(1e-3 * i, 1e-4 * k, 1e-4 * k * k);
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  const auto mesh = mesh_of(surface);
  const TriangleTree tree(mesh);
  for (const Vec3& place : {Vec3(1, 2, 3), Vec3(0.5, 0, 0), Vec3(-10, 3, 0.5), Vec3(1e6, 0, 0)}) {
    const Bounds box{place, place};
    std::vector<TriangleId> expected, found;
    for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
      if (bounds_of(mesh->triangle(t)).overlaps(box)) expected.push_back(t);
    }
    tree.collect(box, found);
    EXPECT_EQ(sorted(found), expected);
  }
  EXPECT_EQ(tree.nearest({1, 2, 4}, narrow_distance).distance.estimate, 1.0);
}

TEST(Bounds, InflatedHoldWhatIsWithinReachWhateverTheRounding) {
  Random random(5);
  for (int i = 0; i < 100'000; ++i) {
    const double world = std::pow(10.0, random.uniform(-3.0, 8.0));
    const double reach = std::pow(10.0, random.uniform(-12.0, 2.0));
    const Vec3 place = world * random.direction();
    const Bounds box = inflated({place, place}, reach);
    for (int k = 0; k < 3; ++k) {
      ASSERT_GT(static_cast<long double>(box.high[k]), static_cast<long double>(place[k]) + reach);
      ASSERT_LT(static_cast<long double>(box.low[k]), static_cast<long double>(place[k]) - reach);
    }
  }
}

}  // namespace
}  // namespace keepout::oracle
