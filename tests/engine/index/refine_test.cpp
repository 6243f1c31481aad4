// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>
#include <string_view>

#include "keepout/fixtures/shapes.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/query.h"
#include "random_places.h"

namespace keepout {
namespace {

TEST(Refine, KeepsExactlyWhatTouchesTheBallInTheOrderOfIds) {
  for (const std::string_view name : {"star_bumps", "needles", "triangle_soup", "far_cube"}) {
    SCOPED_TRACE(name);
    const Mesh mesh(make_shape(name));
    // All triangles are candidates, the last first.
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
