// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "../geometry/corner_order.h"
#include "keepout/index/query.h"

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

/// Too thin for its side to be trusted: it closes a seam, and single precision may have turned it
/// any way.
bool is_sliver(const Triangle& t) noexcept {
  const double longest2 = std::max(
      {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return !((t[1] - t[0]).cross(t[2] - t[0]).norm() > 1e-5 * longest2);
}

/// How far along the way from a point a triangle is met, in ways; infinite if it is not. A way
/// through an edge meets both triangles there.
double met_at(const Triangle& triangle, const Vec3& from, const Vec3& way) noexcept {
  constexpr double never = std::numeric_limits<double>::infinity();
  constexpr double rim = -1e-14;  // barycentric: so that no way slips through between neighbours
  const Vec3 one = triangle[1] - triangle[0];
  const Vec3 other = triangle[2] - triangle[0];
  const Vec3 across = way.cross(other);
  const double facing = one.dot(across);
  const Vec3 start = from - triangle[0];
  const double u = start.dot(across) / facing;
  const Vec3 turned = start.cross(one);
  const double v = way.dot(turned) / facing;
  const double t = other.dot(turned) / facing;
  const bool is_met = u >= rim && v >= rim && u + v <= 1.0 - rim && t >= 0.0;  // false for NaN
  return is_met ? t : never;
}

/// The surface about the point nearest to a tip.
struct Nearest {
  double distance;
  Vec3 offset;     // from the tip to the nearest point
  Vec3 normal;     // unit: of all that meets there, by its angles; zero if they cancel
  Triangle faced;  // of all that meets there, what faces the tip the most
};

/// Asks the index for what touches a ball. Returns false without room, or work left to look at it.
bool collect(Neighborhood& near, const Ball& ball) noexcept {
  TriangleBuffer& candidates = near.candidates();
  candidates.clear();
  near.index().collect(ball, candidates);
  near.budget().spend(work_of_hit * candidates.size());
  if (candidates.overflowed()) near.budget().mark_overflow();
  return !candidates.overflowed() && !near.budget().is_spent();
}

std::optional<Nearest> look_around(Neighborhood& near, const Vec3& tip, double rounding) noexcept {
  const std::optional<Hit> hit = find_nearest(near, tip);
  if (!hit) return std::nullopt;
  const double as_near = hit->closest.distance * (1.0 + 1e-13) + rounding;
  if (!collect(near, {tip, as_near})) return std::nullopt;
  const Mesh& mesh = near.mesh();
  TriangleBuffer& candidates = near.candidates();
  const auto last = std::partition(candidates.begin(), candidates.end(), [&](TriangleId t) {
    return closest_point(mesh.triangle(t), tip).distance <= as_near;
  });
  std::sort(candidates.begin(), last, [&](TriangleId a, TriangleId b) {
    return comes_before(mesh.triangle(a), mesh.triangle(b));
  });
  const Vec3 none = Vec3::Zero();
  Nearest nearest{hit->closest.distance, hit->closest.offset, none, {none, none, none}};
  double most = -1.0;
  for (const TriangleId* t = candidates.begin(); t != last; ++t) {
    const Triangle triangle = mesh.triangle(*t);
    const ClosestPoint closest = closest_point(triangle, tip);
    const Vec3 normal = unit_normal(triangle);
    nearest.normal += angle_at(triangle, closest.feature) * normal;
    const double facing = is_sliver(triangle) ? 0.0 : std::abs(normal.dot(closest.offset));
    if (!(facing > most)) continue;
    most = facing;
    nearest.offset = closest.offset;
    nearest.faced = triangle;
  }
  const double length = nearest.normal.norm();
  if (length > 0.0) nearest.normal /= length;
  return nearest;
}

}  // namespace

std::optional<Placement> place(Neighborhood& near, const Vec3& tip) noexcept {
  const Mesh& mesh = near.mesh();
  // Beyond the box around the mesh all is one side. From far off, where rounding makes all
  // triangles alike, it is asked about not so far off.
  const Vec3 room = Vec3::Constant(4.0 * mesh.bounds().size().norm());
  const Vec3 nearer = tip.cwiseMax(mesh.bounds().low - room).cwiseMin(mesh.bounds().high + room);
  if (nearer != tip) {
    auto placement = place(near, nearer);
    if (!placement || placement->is_free) return placement;
    const std::optional<Hit> hit = find_nearest(near, tip);
    if (!hit) return std::nullopt;
    placement->distance = hit->closest.distance;
    placement->way_out = hit->closest.offset / hit->closest.distance;
    return placement;
  }
  const double size = (mesh.bounds().high - mesh.bounds().low).norm() + tip.lpNorm<1>();
  const double rounding = 1e-15 * size;
  const auto nearest = look_around(near, tip, rounding);
  if (!nearest) return std::nullopt;
  Placement placement{false, 0.0, nearest->normal, nearest->normal};
  if (nearest->distance <= 1e3 * rounding) return placement;
  placement.distance = nearest->distance;

  // Nothing is nearer than the nearest point, so what is met is met close to it.
  const Triangle& faced = nearest->faced;
  const bool are_slivers_asked = is_sliver(faced);  // there is nothing else
  const Vec3 middle = (faced[0] + faced[1] + faced[2]) / 3.0 - tip;
  const Vec3 inwards = middle - nearest->offset;
  const double share = std::min(1e-3, 0.5 * nearest->distance / inwards.norm());
  const Vec3 way = nearest->offset + share * inwards;
  if (!collect(near, {tip, way.norm() * (1.0 + 1e-9)})) return std::nullopt;
  double first = std::numeric_limits<double>::infinity();
  for (const TriangleId t : near.candidates()) {
    const Triangle triangle = mesh.triangle(t);
    if (are_slivers_asked || !is_sliver(triangle))
      first = std::min(first, met_at(triangle, tip, way));
  }
  // Above 0: the back of what is met first; at an edge, of what faces the tip more.
  double facing = 0.0;
  for (const TriangleId t : near.candidates()) {
    const Triangle triangle = mesh.triangle(t);
    if (!are_slivers_asked && is_sliver(triangle)) continue;
    if (!(met_at(triangle, tip, way) <= first + 1e-12)) continue;
    const double side = unit_normal(triangle).dot(way);
    if (std::abs(side) > std::abs(facing)) facing = side;
  }
  if (facing == 0.0) facing = unit_normal(faced).dot(way);
  placement.is_free = !(facing > 0.0);
  placement.way_out = (facing > 0.0 ? 1.0 : -1.0) * nearest->offset / nearest->distance;
  return placement;
}

}  // namespace keepout
