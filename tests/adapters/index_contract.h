// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <vector>

#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The distance from a point to every triangle: brute force, once for all radii.
inline std::vector<double> distances(const Mesh& mesh, const Vec3& point) {
  std::vector<double> all(mesh.triangle_count());
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    all[t] = closest_point(mesh.triangle(t), point).distance;
  }
  return all;
}

/// Places of every kind that an index might get wrong.
inline std::vector<Vec3> probing_points(const Mesh& mesh, std::size_t of_each_kind) {
  Random random(1);
  const double size = mesh.bounds().size().norm();
  std::vector<Vec3> points;
  for (auto&& kind :
       {random_points(mesh, of_each_kind, random), surface_points(mesh, of_each_kind, 0.0, random),
        surface_points(mesh, of_each_kind, 1e-3 * size, random),
        vertex_points(mesh, of_each_kind, random), edge_points(mesh, of_each_kind, random),
        far_points(mesh, of_each_kind, random)}) {
    points.insert(points.end(), kind.begin(), kind.end());
  }
  return points;
}

/// Radii from zero to the whole mesh, and some that a triangle touches to the last bit.
inline std::vector<double> probing_radii(const Mesh& mesh, const std::vector<double>& distances,
                                         Random& random) {
  const double size = mesh.bounds().size().norm();
  const double nearest = *std::min_element(distances.begin(), distances.end());
  const double farthest = *std::max_element(distances.begin(), distances.end());
  return {0.0,
          nearest,
          std::nextafter(nearest, 0.0),
          nearest + 1e-6 * size,
          nearest + 1e-2 * size,
          nearest + 5e-2 * size,
          distances[random.below(distances.size())],
          farthest};
}

/// Fails unless the index finds, at every place and radius, exactly what brute force finds.
inline void expect_brute_force_sets(const std::shared_ptr<const Mesh>& mesh,
                                    const SpatialIndex& index, std::size_t of_each_kind) {
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  Random random(2);
  for (const Vec3& point : probing_points(*mesh, of_each_kind)) {
    const std::vector<double> distance = distances(*mesh, point);
    for (const double radius : probing_radii(*mesh, distance, random)) {
      candidates.clear();
      hits.clear();
      index.collect({point, radius}, candidates);
      ASSERT_FALSE(candidates.overflowed()) << "a triangle was given twice";
      refine(*mesh, {point, radius}, candidates.view(), hits);

      std::size_t next = 0;
      for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
        if (distance[t] > radius) continue;
        ASSERT_LT(next, hits.size()) << "misses triangle " << t << " of radius " << radius;
        ASSERT_EQ(hits[next].triangle, t) << "at " << point.transpose() << " radius " << radius;
        ASSERT_EQ(hits[next].closest.distance, distance[t]);
        ++next;
      }
      ASSERT_EQ(next, hits.size());
    }
  }
}

/// What a test prints of a backend.
inline void PrintTo(const IndexBackend& backend, std::ostream* out) { *out << backend.name; }

}  // namespace keepout
