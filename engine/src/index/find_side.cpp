// SPDX-License-Identifier: BSD-3-Clause
//
// Finds the side of a watertight mesh on which a point is.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "../geometry/corner_order.h"
#include "keepout/index/query.h"

namespace keepout {
namespace {

/// Returns the angle of a triangle around one of its points. [rad]
double angle_at(const Triangle& triangle, Feature feature) noexcept {
  if (is_face(feature)) return 2.0 * std::numbers::pi;
  if (is_edge(feature)) return std::numbers::pi;
  const int v = number_of(feature);
  const Vec3 one = triangle[(v + 1) % 3] - triangle[v];
  const Vec3 other = triangle[(v + 2) % 3] - triangle[v];
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// Returns true if a triangle is too thin for a reliable normal. Such a triangle closes a seam, and
/// rounding to single precision may have turned it over.
bool is_sliver(const Triangle& t) noexcept {
  const double longest2 = std::max(
      {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return !((t[1] - t[0]).cross(t[2] - t[0]).norm() > 1e-5 * longest2);
}

/// Returns the fraction of the probe at which the probe meets a triangle; infinite if it does not.
/// A probe through an edge meets both triangles there.
double met_at(const Triangle& triangle, const Vec3& from, const Vec3& probe) noexcept {
  constexpr double never = std::numeric_limits<double>::infinity();
  constexpr double rim = -1e-14;  // barycentric, so that no probe passes between neighbors
  const Vec3 one = triangle[1] - triangle[0];
  const Vec3 other = triangle[2] - triangle[0];
  const Vec3 across = probe.cross(other);
  const double facing = one.dot(across);
  const Vec3 start = from - triangle[0];
  const double u = start.dot(across) / facing;
  const Vec3 turned = start.cross(one);
  const double v = probe.dot(turned) / facing;
  const double t = other.dot(turned) / facing;
  const bool is_met = u >= rim && v >= rim && u + v <= 1.0 - rim && t >= 0.0;  // false for NaN
  return is_met ? t : never;
}

/// A probe: a segment from a point to a place close to the nearest point of the surface, inside the
/// triangle there that faces the point the most. The first triangle that the probe meets decides
/// the side of its start. So the side depends neither on a sum of normals nor on the rounding that
/// decides which of several triangles is nearest.
struct Probe {
  Vec3 start;
  Vec3 segment;    // from the start [length]
  Vec3 offset;     // from the start to the nearest point of the surface [length]
  Vec3 normal;     // unit, the mean of all triangles there, weighted by their angles; zero if they
                   // cancel out
  Triangle faced;  // the triangle that faces the start the most
};

/// Returns the probe of a point. `nearest`: the triangles that touch the ball of radius `as_near`
/// around the point, which contains all nearest triangles. Reorders `nearest`.
Probe aimed_probe(const Mesh& mesh, const Vec3& point, const ClosestPoint& closest, double as_near,
                  std::span<TriangleId> nearest) noexcept {
  Probe probe{point, Vec3::Zero(), closest.offset, Vec3::Zero(), {}};
  probe.faced.fill(Vec3::Zero());
  const auto last = std::partition(nearest.begin(), nearest.end(), [&](TriangleId t) {
    return closest_point(mesh.triangle(t), point).distance <= as_near;
  });
  std::sort(nearest.begin(), last, [&](TriangleId a, TriangleId b) {
    return comes_before(mesh.triangle(a), mesh.triangle(b));
  });
  double most = -1.0;
  for (auto t = nearest.begin(); t != last; ++t) {
    const Triangle triangle = mesh.triangle(*t);
    const ClosestPoint to = closest_point(triangle, point);
    const Vec3 normal = unit_normal(triangle);
    probe.normal += angle_at(triangle, to.feature) * normal;
    const double facing = is_sliver(triangle) ? 0.0 : std::abs(normal.dot(to.offset));
    if (!(facing > most)) continue;
    most = facing;
    probe.offset = to.offset;
    probe.faced = triangle;
  }
  const double length = probe.normal.norm();
  if (length > 0.0) probe.normal /= length;

  // No point of the surface is nearer than the nearest point, so the probe meets the surface close
  // to it.
  const Triangle& faced = probe.faced;
  const Vec3 middle = (faced[0] + faced[1] + faced[2]) / 3.0 - point;
  const Vec3 inwards = middle - probe.offset;
  const double share = std::min(1e-3, 0.5 * closest.distance / inwards.norm());
  probe.segment = probe.offset + share * inwards;
  return probe;
}

/// Returns true if a probe starts on the forbidden side. `candidates`: the triangles that touch the
/// ball around the probe's start with the probe's length, in any order.
bool starts_inside(const Mesh& mesh, const Probe& probe,
                   std::span<const TriangleId> candidates) noexcept {
  const bool are_slivers_asked = is_sliver(probe.faced);  // the surface there has only slivers
  double first = std::numeric_limits<double>::infinity();
  for (const TriangleId t : candidates) {
    const Triangle triangle = mesh.triangle(t);
    if (!are_slivers_asked && is_sliver(triangle)) continue;
    first = std::min(first, met_at(triangle, probe.start, probe.segment));
  }
  // Positive if the probe meets a back face first, which means that the point is behind the
  // surface. At an edge, the triangle that faces the point more decides.
  double from_behind = 0.0;
  for (const TriangleId t : candidates) {
    const Triangle triangle = mesh.triangle(t);
    if (!are_slivers_asked && is_sliver(triangle)) continue;
    if (!(met_at(triangle, probe.start, probe.segment) <= first + 1e-12)) continue;
    const double side = unit_normal(triangle).dot(probe.segment);
    if (std::abs(side) > std::abs(from_behind)) from_behind = side;
  }
  if (from_behind == 0.0) from_behind = unit_normal(probe.faced).dot(probe.segment);
  // The probe changes sides at each sliver that it meets before the deciding triangle. Slivers may
  // be turned over, so their winding does not count.
  bool is_behind = from_behind > 0.0;
  for (const TriangleId t : candidates) {
    const Triangle triangle = mesh.triangle(t);
    if (are_slivers_asked || !is_sliver(triangle)) continue;
    if (met_at(triangle, probe.start, probe.segment) < first - 1e-12) is_behind = !is_behind;
  }
  return is_behind;
}

/// Classifies a point that is not far away: see find_side.
std::optional<SideOfSurface> find_side_by_probe(Neighborhood& neighborhood,
                                                const Vec3& point) noexcept {
  const std::optional<Hit> hit = find_nearest(neighborhood, point);
  if (!hit) return std::nullopt;
  const Mesh& mesh = neighborhood.mesh();
  TriangleBuffer& candidates = neighborhood.candidates();
  const double distance = hit->closest.distance;
  const double size = (mesh.bounds().high - mesh.bounds().low).norm() + point.lpNorm<1>();
  const double rounding = 1e-15 * size;  // [length]
  const double as_near = distance * (1.0 + 1e-13) + rounding;
  if (!neighborhood.collect({point, as_near})) return std::nullopt;
  const Probe probe =
      aimed_probe(mesh, point, hit->closest, as_near, {candidates.begin(), candidates.end()});
  if (distance <= 1e3 * rounding) return SideOfSurface{false, 0.0, probe.normal, probe.normal};
  if (!neighborhood.collect({point, probe.segment.norm() * (1.0 + 1e-9)})) return std::nullopt;
  const bool is_inside = starts_inside(mesh, probe, candidates.view());
  return SideOfSurface{!is_inside, distance, (is_inside ? 1.0 : -1.0) * probe.offset / distance,
                       probe.normal};
}

}  // namespace

std::optional<SideOfSurface> find_side(Neighborhood& neighborhood, const Vec3& point) noexcept {
  // Beyond the bounds all points are on one side. If a point is so far away that rounding makes all
  // triangles equally near, a nearer point replaces it.
  const Box& bounds = neighborhood.mesh().bounds();
  const Vec3 beyond = Vec3::Constant(4.0 * bounds.size().norm());
  const Vec3 nearer = point.cwiseMax(bounds.low - beyond).cwiseMin(bounds.high + beyond);
  auto side = find_side_by_probe(neighborhood, nearer);
  if (nearer == point || !side || side->is_outside) return side;
  const std::optional<Hit> hit = find_nearest(neighborhood, point);
  if (!hit) return std::nullopt;
  side->distance = hit->closest.distance;
  side->outward = hit->closest.offset / hit->closest.distance;
  return side;
}

}  // namespace keepout
