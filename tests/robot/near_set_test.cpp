// SPDX-License-Identifier: BSD-3-Clause
#include "near_set.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/index/wide_bvh.h"
#include "meshes.h"
#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout {
namespace {

// Cores of one, two and four points wander near a mesh; what is listed of each cycle is held to the
// gap of every triangle, while triangles become known and more and more are asked for.
TEST(NearSet, TellsAllThatIsNearOnceAndAllocatesNothing) {
  Random random(1);
  std::size_t listed_of = 0;
  for (const char* shape : {"cube", "gear"}) {
    const auto mesh = mesh_of(shape);
    Budget budget;
    Neighborhood near(mesh, std::make_shared<WideBvh>(mesh), mesh->triangle_count(), budget);
    for (const std::size_t points : {1u, 2u, 4u}) {
      const double width = points > 2 ? 1.0 : 0.0;
      NearSet set(near.room(), 2.0 * width);
      for (int i = 0; i < test::trials(200); ++i) {
        std::vector<Vec3> core{10.0 * random.direction()};
        if (points > 1) core.push_back(core[0] + 10.0 * random.uniform() * random.direction());
        while (core.size() < points) core.push_back(core[0] + width * random.direction());
        const double radius = random.uniform(0.0, 8.0);
        std::vector<double> distances;
        for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
          distances.push_back(gap(core, mesh->triangle(t)).distance);
        }
        const std::size_t before = allocations();
        ASSERT_TRUE(set.gather(near, core, radius, budget));
        ASSERT_EQ(allocations(), before);
        for (int cycle = 0; cycle < 3; ++cycle) {
          for (const double share : {0.1, 0.5, 0.9, 1.0}) {
            const std::size_t until = allocations();
            const std::span<NearTriangle> listed = set.nearer_than(share * radius, budget);
            for (NearTriangle& triangle : listed) set.measure(triangle, budget);
            ASSERT_EQ(allocations(), until) << shape;
            std::set<TriangleId> ids;
            for (const NearTriangle& triangle : listed) {
              ASSERT_TRUE(ids.insert(triangle.id).second) << "listed twice";
              ASSERT_LE(triangle.at_least, distances[triangle.id] + 1e-12);
              ASSERT_EQ(triangle.at_start.distance, distances[triangle.id]);
            }
            for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
              ASSERT_TRUE(distances[t] >= share * radius || ids.contains(t)) << shape << ' ' << t;
            }
            listed_of += ids.size();
          }
          set.start_listing(core);
        }
      }
    }
  }
  EXPECT_GT(listed_of, test::trials(20'000u));
}

}  // namespace
}  // namespace keepout
