// SPDX-License-Identifier: BSD-3-Clause
#include <numeric>

#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/testing/index_probes.h"
#include "meshes.h"

namespace keepout {
namespace {

/// Returns a surface whose coordinates do not fit in a float, so the leaves store them rounded.
Surface in_odd_numbers(Surface surface) {
  for (Vec3& vertex : surface.vertices) vertex = vertex / 3.0 + Vec3(0.1, -200.0 / 7.0, 1e3 / 3.0);
  return surface;
}

template <class Index>
void expect_nearest_of(const std::shared_ptr<const Mesh>& mesh, std::size_t of_each_kind) {
  const Index index(mesh);
  NearestTriangle nearest(*mesh, index);
  for (const Vec3& point : probing_points(*mesh, of_each_kind)) {
    const std::vector<double> distance = distances(*mesh, point);
    const auto expected = std::min_element(distance.begin(), distance.end());
    for (const double guess : {0.0, 0.5 * *expected, *expected, 3.0 * *expected}) {
      const Hit hit = nearest(point, guess);
      ASSERT_EQ(hit.triangle, expected - distance.begin()) << point.transpose();
      ASSERT_EQ(hit.closest.distance, *expected);
    }
  }
}

template <class Index>
class NearestTriangleOf : public testing::Test {};

using AnyIndex = testing::Types<WideBvh, PdTree, BruteForce>;
TYPED_TEST_SUITE(NearestTriangleOf, AnyIndex);

TYPED_TEST(NearestTriangleOf, IsTheOneThatBruteForceFindsAndTheLowestAmongEquals) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    expect_nearest_of<TypeParam>(mesh_of(shape.make()), 10);
    expect_nearest_of<TypeParam>(mesh_of(in_odd_numbers(shape.make())), 3);
  }
}

TEST(NearestTriangle, IsTheSameOnEveryProcessor) {
  const auto mesh = mesh_of("cortex");
  for (const std::string_view target : simd_targets()) {
    SCOPED_TRACE(target);
    use_simd_target(target);
    expect_nearest_of<WideBvh>(mesh, 20);
  }
  use_simd_target(simd_targets().front());
}

TEST(NearestTriangle, IsFoundHoweverFarOffThePointIs) {
  for (const char* shape : {"cube", "cortex", "crown"}) {
    const auto mesh = mesh_of(in_odd_numbers(make_shape(shape)));
    const WideBvh tree(mesh);
    const BruteForce brute(mesh);
    Budget unlimited;
    Random random(4);
    for (double times = 1.0; times < 1e13; times *= 3.0) {
      const Vec3 way = times * mesh->bounds().size().norm() * random.direction();
      const Vec3 point = mesh->bounds().center() + way;
      ASSERT_EQ(tree.nearest(point, unlimited), brute.nearest(point, unlimited))
          << shape << ", " << times;
      const Vec3 along(point.x(), 0.0, 0.0);  // many triangles are about equally far away
      ASSERT_EQ(tree.nearest(along, unlimited), brute.nearest(along, unlimited))
          << shape << ", " << times;
    }
  }
}

TEST(NearestTriangle, IsNotLookedForOnceTheBudgetIsSpent) {
  const auto mesh = mesh_of("sphere");
  const WideBvh tree(mesh);
  for (const Vec3& point : {Vec3(0, 0, 0), Vec3(0, 0, 60), Vec3(1e9, 0, 0)}) {
    Budget unlimited;
    const TriangleId nearest = tree.nearest(point, unlimited);
    ASSERT_NE(nearest, no_triangle);
    Budget enough(unlimited.spent() + 1);
    EXPECT_EQ(tree.nearest(point, enough), nearest);
    Budget too_little(unlimited.spent() / 2);
    EXPECT_EQ(tree.nearest(point, too_little), no_triangle);
    EXPECT_LE(too_little.spent(), unlimited.spent() / 2 + LeafBlock::lanes);
  }
}

TEST(NearestTriangle, IsFoundWhereFloatsOverflow) {
  for (const double scale : {1e-25, 1e17, 1e25}) {
    const auto mesh = mesh_of(enlarged(make_shape("cube"), scale));
    const WideBvh tree(mesh);
    const BruteForce brute(mesh);
    Budget unlimited;
    Random random(4);
    for (int i = 0; i < 200; ++i) {
      const Vec3 point = random.uniform(0.0, 200.0) * scale * random.direction();
      ASSERT_EQ(tree.nearest(point, unlimited), brute.nearest(point, unlimited)) << scale;
    }
  }
}

TEST(NearestTriangle, GrowsItsMemoryWhenABallHoldsTheWholeMesh) {
  const auto mesh = mesh_of(make_sphere(2.0));
  ASSERT_GT(mesh->triangle_count(), 5000u);
  const PdTree tree(mesh);
  NearestTriangle nearest(*mesh, tree);
  EXPECT_NEAR(nearest(Vec3::Zero(), 1000.0).closest.distance, 50.0, 0.1);
}

TEST(Refine, KeepsExactlyWhatTouchesTheBallInTheOrderOfIds) {
  for (const std::string_view name : {"star_bumps", "needles", "triangle_soup", "far_cube"}) {
    SCOPED_TRACE(name);
    const Mesh mesh(make_shape(name));
    // All triangles are candidates, in reverse order.
    std::vector<TriangleId> candidates(mesh.triangle_count());
    std::iota(candidates.rbegin(), candidates.rend(), TriangleId{0});
    HitBuffer hits(mesh.triangle_count());
    Random random(4);
    for (const Vec3& point : random_points(mesh, 20, random)) {
      const double exactly = closest_point(mesh.triangle(candidates[0]), point).distance;
      for (const double radius : {0.0, exactly, std::nextafter(exactly, 0.0), 1e9}) {
        hits.clear();
        refine(mesh, {point, radius}, candidates, hits);
        std::size_t next = 0;
        for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
          const double distance = closest_point(mesh.triangle(t), point).distance;
          if (distance > radius) continue;
          ASSERT_LT(next, hits.size());
          ASSERT_EQ(hits[next].triangle, t);
          ASSERT_EQ(hits[next].closest.distance, distance);
          ++next;
        }
        ASSERT_EQ(next, hits.size());
      }
    }
  }
}

}  // namespace
}  // namespace keepout
