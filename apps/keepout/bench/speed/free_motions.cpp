// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/free_motions.h"

#include <algorithm>

#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/nearest.h"

namespace keepout::app {
namespace {

constexpr int most_tries = 1000;

Vec3 somewhere_free(const Mesh& mesh, NearestTriangle& nearest, const FreeSpace& space,
                    Random& random) {
  const double middle = 0.5 * (space.nearest + space.farthest);
  for (const Vec3& tip : surface_points(mesh, most_tries, middle, random)) {
    const double distance = nearest(tip, middle).closest.distance;
    if (distance > space.nearest && distance < space.farthest) return tip;
  }
  throw Error("hardly anywhere has the mesh free space around it; is it in another unit?");
}

}  // namespace

std::vector<Motion> free_motions(const Mesh& mesh, const SpatialIndex& index, std::size_t count,
                                 const FreeSpace& space, const MotionKind& kind, Random& random) {
  NearestTriangle nearest(mesh, index);
  std::vector<Motion> motions;
  Vec3 tip = somewhere_free(mesh, nearest, space, random);
  Vec3 heading = random.direction();
  double distance = nearest(tip, space.farthest).closest.distance;
  while (motions.size() < count) {
    heading = (heading + 0.1 * random.direction()).normalized();
    const double length = random.uniform(kind.shortest, kind.longest);
    const Hit hit = nearest(tip, distance + kind.longest);
    distance = hit.closest.distance;
    // At the bounds of the space it turns around, gently.
    const Vec3 away = -hit.closest.offset / distance;
    constexpr double gentle = 0.3;
    if (distance < space.nearest + 5.0 * kind.longest) heading += gentle * away;
    if (distance > space.farthest - 5.0 * kind.longest) heading -= gentle * away;
    heading.normalize();
    // Where that is not enough it turns on the spot.
    if (distance < space.nearest + kind.longest) heading = away;
    if (distance > space.farthest - kind.longest) heading = -away;
    motions.push_back({.tip = tip, .desired = length * heading});
    tip += motions.back().desired;
  }
  return motions;
}

}  // namespace keepout::app
