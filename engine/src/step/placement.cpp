// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "../geometry/corner_order.h"
#include "keepout/index/nearest.h"

namespace keepout {
namespace {

/// Part of the full turn around a point of a triangle that the triangle takes up. [rad]
double angle_at(const Triangle& triangle, Feature feature) noexcept {
  if (is_face(feature)) return 2.0 * std::numbers::pi;
  if (is_edge(feature)) return std::numbers::pi;
  const int v = number_of(feature);
  const Vec3 one = triangle[(v + 1) % 3] - triangle[v];
  const Vec3 other = triangle[(v + 2) % 3] - triangle[v];
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// By the corners, each triangle's in lexicographic order: so sums do not depend on numbering.
bool before(const Triangle& a, const Triangle& b) noexcept {
  const CornerOrder order_a = corner_order(a);
  const CornerOrder order_b = corner_order(b);
  for (int i = 0; i < 3; ++i) {
    const Vec3& one = a[order_a.corner[i]];
    const Vec3& other = b[order_b.corner[i]];
    if (one != other) {
      return std::lexicographical_compare(one.begin(), one.end(), other.begin(), other.end());
    }
  }
  return false;
}

/// Of triangles that are all but equally near, the one that tells the side most surely: a face
/// tells it alone, an edge with its neighbour, a vertex with all around it. Where the tip is right
/// over the rim of a face, rounding may make the edge nearer by a last digit, and the other face at
/// it, alone, tells the wrong side.
struct Witness {
  Triangle triangle;
  ClosestPoint closest;

  int rank() const noexcept {
    return is_face(closest.feature) ? 0 : is_edge(closest.feature) ? 1 : 2;
  }
  bool is_surer_than(const Witness& other) const noexcept {
    if (rank() != other.rank()) return rank() < other.rank();
    return before(triangle, other.triangle);
  }
};

}  // namespace

std::optional<Placement> place(const Mesh& mesh, const SpatialIndex& index, const Vec3& tip,
                               TriangleBuffer& candidates) noexcept {
  const std::optional<Hit> nearest = find_nearest(mesh, index, tip, 0.0, candidates);
  if (!nearest) return std::nullopt;
  const double rounding = 1e-15 * (nearest->closest.offset + tip).lpNorm<1>();
  const double near = nearest->closest.distance * (1.0 + 1e-13) + rounding;
  const auto witness = [&](TriangleId t) {
    const Triangle triangle = mesh.triangle(t);
    return Witness{triangle, closest_point(triangle, tip)};
  };
  const auto last = std::partition(candidates.begin(), candidates.end(), [&](TriangleId t) {
    return witness(t).closest.distance <= near;
  });
  Witness surest = witness(nearest->triangle);
  for (const TriangleId* t = candidates.begin(); t != last; ++t) {
    const Witness other = witness(*t);
    if (other.is_surer_than(surest)) surest = other;
  }

  // Neighbours have the same closest point to the last bit, so it tells who meets there.
  const auto [triangle, closest] = surest;
  Vec3 normal = unit_normal(triangle);
  if (!is_face(closest.feature)) {
    std::sort(candidates.begin(), last, [&](TriangleId a, TriangleId b) {
      return before(mesh.triangle(a), mesh.triangle(b));
    });
    normal.setZero();
    for (const TriangleId* t = candidates.begin(); t != last; ++t) {
      const Witness one = witness(*t);
      if (one.closest.offset != closest.offset) continue;
      normal += angle_at(one.triangle, one.closest.feature) * unit_normal(one.triangle);
    }
  }

  const double length = normal.norm();
  if (length > 0.0) normal /= length;
  Placement placement{Placement::Side::free, closest.distance, normal, normal};
  // On the surface itself only the normal tells where to go.
  if (closest.distance <= 1e3 * rounding) {
    placement.side = Placement::Side::forbidden;
    return placement;
  }
  placement.way_out = -closest.offset / closest.distance;
  if (normal.dot(closest.offset) <= 0.0) return placement;
  placement.side = Placement::Side::forbidden;
  placement.way_out = closest.offset / closest.distance;
  return placement;
}

Vec3 lead_out(const Placement& placement, double recovery) noexcept {
  // Well off the surface. No farther beyond it than it was deep, as another wall may be there.
  const double least = 1e-4 * recovery;
  if (2.0 * placement.distance < least) return least * placement.normal;
  return std::min(recovery, 2.0 * placement.distance) * placement.way_out;
}

}  // namespace keepout
