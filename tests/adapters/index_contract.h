// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "brute_force.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/spatial_index.h"
#include "meshes.h"

namespace keepout {

/// Places of every kind that an index might get wrong; fewer under sanitizers.
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

/// A place to ask at, what brute force says there, and the radii to ask for.
struct Probe {
  Vec3 point;
  std::vector<double> distances;  // of every triangle
  std::vector<double> radii;
};

/// Worked out once for all the indices of a mesh.
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
/// and none twice; and at every place the nearest of them, if it has a search of its own for that.
inline void expect_brute_force_sets(const Mesh& mesh, const SpatialIndex& index,
                                    const std::vector<Probe>& probes) {
  TriangleBuffer candidates(mesh.triangle_count());
  std::vector<std::size_t> found(mesh.triangle_count(), 0);  // in which question
  std::size_t question = 0;
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
      ++question;
      for (const TriangleId t : candidates) {
        ASSERT_LT(t, found.size());
        ASSERT_NE(found[t], question) << "gives triangle " << t << " twice";
        found[t] = question;
      }
      for (TriangleId t = 0; t < found.size(); ++t) {
        if (probe.distances[t] > radius || found[t] == question) continue;
        FAIL() << "misses triangle " << t << " at " << probe.point.transpose() << " radius "
               << radius << ", " << radius - probe.distances[t] << " within it";
      }
    }
  }
}

/// What a test prints of a backend.
inline void PrintTo(const IndexBackend& backend, std::ostream* out) { *out << backend.name; }

}  // namespace keepout
