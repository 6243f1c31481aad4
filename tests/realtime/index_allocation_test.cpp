// SPDX-License-Identifier: BSD-3-Clause
// That an index takes nothing from the heap while it answers, unless its row says that it does.
#include <gtest/gtest.h>

#include "keepout/adapters/all_indices.h"
#include "keepout/fixtures/poses.h"
#include "meshes.h"
#include "messages.h"
#include "random_places.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

TEST(Index, AllocatesNothingWhileItAnswersUnlessItSaysSo) {
  const auto mesh = mesh_of("cortex");
  const double size = mesh->bounds().size().norm();
  Random random(6);
  std::vector<Vec3> points = surface_points(*mesh, 100, 0.5, random);
  const std::vector<Vec3> far = far_points(*mesh, 20, random);
  points.insert(points.end(), far.begin(), far.end());
  for (const IndexBackend& backend : all_index_backends()) {
    SCOPED_TRACE(backend.name);
    const std::unique_ptr<SpatialIndex> index = backend.make(mesh);
    TriangleBuffer candidates(mesh->triangle_count());
    std::size_t found = 0;
    const std::size_t before = allocations();  // the first answer counts, too
    for (const Vec3& point : points) {
      for (const double radius : {0.0, 1.0, 10.0, size, 1e6 * size}) {
        candidates.clear();
        index->collect({point, radius}, candidates);
        found += candidates.size();
      }
    }
    if (backend.allocation == Allocation::never) {
      EXPECT_EQ(allocations(), before);
    } else {
      EXPECT_GT(allocations(), before) << "is fit for real time: its row may say so";
      EXPECT_CONTAINS(backend.description, "not for real time");
    }
    EXPECT_GT(found, points.size() * mesh->triangle_count());
  }
}

TEST(Index, OnlyFclsOwnQueryAllocates) {
  for (const IndexBackend& backend : all_index_backends()) {
    EXPECT_EQ(backend.allocation == Allocation::inside, backend.name == "fcl_collide")
        << backend.name;
  }
}

}  // namespace
}  // namespace keepout
