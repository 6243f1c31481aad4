// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <utility>
#include <vector>

#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/spatial_index.h"
#include "keepout/testing/places.h"
#include "keepout/testing/trials.h"

namespace keepout {

/// Returns the distances from a point to all triangles.
inline std::vector<double> distances(const Mesh& mesh, const Vec3& point) {
  std::vector<double> all(mesh.triangle_count());
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    all[t] = closest_point(mesh.triangle(t), point).distance;
  }
  return all;
}

/// Returns places of every kind that an index might get wrong; fewer in short tests.
inline std::vector<Vec3> probing_points(const Mesh& mesh, std::size_t of_each_kind) {
  of_each_kind = test::trials(of_each_kind);
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

/// Returns radii from zero to the whole mesh, and some that a triangle touches exactly.
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

/// A place of queries, the distances by brute force, and the radii of the queries.
struct Probe {
  Vec3 point;
  std::vector<double> distances;  // of every triangle
  std::vector<double> radii;
};

/// Returns the probes of a mesh, which serve all indices.
inline std::vector<Probe> probes(const Mesh& mesh, std::size_t of_each_kind) {
  Random random(2);
  std::vector<Probe> all;
  for (const Vec3& point : probing_points(mesh, of_each_kind)) {
    Probe probe{point, distances(mesh, point), {}};
    probe.radii = probing_radii(mesh, probe.distances, random);
    all.push_back(std::move(probe));
  }
  return all;
}

/// Fails unless the index finds, at every place and radius, each triangle that brute force finds,
/// and no triangle twice. An index with its own search for the nearest triangle must find that one.
inline void expect_brute_force_sets(const Mesh& mesh, const SpatialIndex& index,
                                    const std::vector<Probe>& probes) {
  TriangleBuffer candidates(mesh.triangle_count());
  std::vector<std::size_t> found(mesh.triangle_count(), 0);  // the last query with the triangle
  std::size_t query = 0;
  Budget unlimited;
  for (const Probe& probe : probes) {
    if (const TriangleId nearest = index.nearest(probe.point, unlimited); nearest != no_triangle) {
      const auto least = std::min_element(probe.distances.begin(), probe.distances.end());
      ASSERT_EQ(nearest, least - probe.distances.begin())
          << "nearest to " << probe.point.transpose();
    }
    for (const double radius : probe.radii) {
      candidates.clear();
      index.collect({probe.point, radius}, candidates);
      ASSERT_FALSE(candidates.overflowed()) << "a triangle was given twice";
      ++query;
      for (const TriangleId t : candidates) {
        ASSERT_LT(t, found.size());
        ASSERT_NE(found[t], query) << "gives triangle " << t << " twice";
        found[t] = query;
      }
      for (TriangleId t = 0; t < found.size(); ++t) {
        if (probe.distances[t] > radius || found[t] == query) continue;
        FAIL() << "misses triangle " << t << " at " << probe.point.transpose() << " radius "
               << radius << ", " << radius - probe.distances[t] << " within it";
      }
    }
  }
}

/// Prints an index in the messages of a test.
inline void PrintTo(const IndexBackend& backend, std::ostream* out) { *out << backend.name; }

}  // namespace keepout
