// SPDX-License-Identifier: BSD-3-Clause
#include "side_probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "../geometry/corner_order.h"

namespace keepout {
namespace {

/// Returns the angle that a triangle takes up around one of its points. [rad]
double angle_at(const Triangle& triangle, Feature feature) noexcept {
  if (is_face(feature)) return 2.0 * std::numbers::pi;
  if (is_edge(feature)) return std::numbers::pi;
  const int v = number_of(feature);
  const Vec3 one = triangle[(v + 1) % 3] - triangle[v];
  const Vec3 other = triangle[(v + 2) % 3] - triangle[v];
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// Returns true if a triangle is too thin for its normal to be reliable: it closes a seam, and
/// rounding to single precision may have turned it.
bool is_sliver(const Triangle& t) noexcept {
  const double longest2 = std::max(
      {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return !((t[1] - t[0]).cross(t[2] - t[0]).norm() > 1e-5 * longest2);
}

/// Returns the fraction of the probe at which it meets a triangle; infinite if it does not. A probe
/// through an edge meets both triangles there.
double met_at(const Triangle& triangle, const Vec3& from, const Vec3& probe) noexcept {
  constexpr double never = std::numeric_limits<double>::infinity();
  constexpr double rim = -1e-14;  // barycentric: no probe slips through between neighbors
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

}  // namespace

SideProbe::SideProbe(const Mesh& mesh, const Vec3& point, const ClosestPoint& nearest) noexcept
    : mesh_(mesh), point_(point), distance_(nearest.distance), offset_(nearest.offset) {
  const double size = (mesh.bounds().high - mesh.bounds().low).norm() + point.lpNorm<1>();
  rounding_ = 1e-15 * size;
  as_near_ = distance_ * (1.0 + 1e-13) + rounding_;
}

void SideProbe::aim(std::span<TriangleId> candidates) noexcept {
  const auto last = std::partition(candidates.begin(), candidates.end(), [&](TriangleId t) {
    return closest_point(mesh_.triangle(t), point_).distance <= as_near_;
  });
  std::sort(candidates.begin(), last, [&](TriangleId a, TriangleId b) {
    return comes_before(mesh_.triangle(a), mesh_.triangle(b));
  });
  double most = -1.0;
  for (auto t = candidates.begin(); t != last; ++t) {
    const Triangle triangle = mesh_.triangle(*t);
    const ClosestPoint closest = closest_point(triangle, point_);
    const Vec3 normal = unit_normal(triangle);
    normal_ += angle_at(triangle, closest.feature) * normal;
    const double facing = is_sliver(triangle) ? 0.0 : std::abs(normal.dot(closest.offset));
    if (!(facing > most)) continue;
    most = facing;
    offset_ = closest.offset;
    faced_ = triangle;
  }
  const double length = normal_.norm();
  if (length > 0.0) normal_ /= length;

  // Nothing is nearer than the nearest point, so the probe meets the surface close to it.
  const Vec3 middle = (faced_[0] + faced_[1] + faced_[2]) / 3.0 - point_;
  const Vec3 inwards = middle - offset_;
  const double share = std::min(1e-3, 0.5 * distance_ / inwards.norm());
  probe_ = offset_ + share * inwards;
}

SideOfSurface SideProbe::side(std::span<const TriangleId> candidates) const noexcept {
  if (is_on_surface()) return {false, 0.0, normal_, normal_};
  const bool are_slivers_asked = is_sliver(faced_);  // there is nothing else
  double first = std::numeric_limits<double>::infinity();
  for (const TriangleId t : candidates) {
    const Triangle triangle = mesh_.triangle(t);
    if (!are_slivers_asked && is_sliver(triangle)) continue;
    first = std::min(first, met_at(triangle, point_, probe_));
  }
  // Positive if the probe meets a back face first: the point sees the surface from behind. At an
  // edge, the triangle counts that faces the point more.
  double from_behind = 0.0;
  for (const TriangleId t : candidates) {
    const Triangle triangle = mesh_.triangle(t);
    if (!are_slivers_asked && is_sliver(triangle)) continue;
    if (!(met_at(triangle, point_, probe_) <= first + 1e-12)) continue;
    const double side = unit_normal(triangle).dot(probe_);
    if (std::abs(side) > std::abs(from_behind)) from_behind = side;
  }
  if (from_behind == 0.0) from_behind = unit_normal(faced_).dot(probe_);
  const bool is_inside = from_behind > 0.0;
  return {!is_inside, distance_, (is_inside ? 1.0 : -1.0) * offset_ / distance_, normal_};
}

}  // namespace keepout
