// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/free_polytope.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "../../geometry/corner_order.h"
#include "free_polytope_triangle.h"
#include "keepout/error.h"

namespace keepout {
namespace {

// The standoff of a plane from the triangle that it separates, so that it separates neighbors too.
// It is a fraction of the radius, but at most a fraction of the plane's distance from the tip, so
// that the tip can still get close.
constexpr double standoff_of_radius = 0.01;
constexpr double standoff_of_room = 0.25;

bool is_length(double x) noexcept { return x >= 0.0 && x <= longest_length; }  // false for NaN

/// Returns points spread evenly in the unit ball. Source: Roberts, "The unreasonable effectiveness
/// of quasirandom sequences", 2018: multiples of powers of 1 / g, where g^4 = g + 1.
template <std::size_t count>
std::array<Vec3, count> points_in_unit_ball() noexcept {
  constexpr double g = 1.2207440846057596;
  const Vec3 stride(1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g));
  std::array<Vec3, count> points;
  std::size_t n = 0;
  for (double k = 1.0; n < count; k += 1.0) {
    const Vec3 multiple = k * stride;
    const Vec3 point = 2.0 * (multiple - Vec3(multiple.array().floor())) - Vec3::Ones();
    if (point.squaredNorm() <= 1.0) points[n++] = point;
  }
  return points;
}

/// Returns the direction from the closest point to the tip. On an edge the direction is made
/// perpendicular to it, because the rounding of a short offset would leave a tip very near to an
/// edge without a valid plane.
Vec3 away_from(const ClosestPoint& closest, const Triangle& triangle) noexcept {
  Vec3 away = -closest.offset / closest.distance;
  if (is_edge(closest.feature)) {
    const int e = number_of(closest.feature);
    const Vec3 edge = triangle[(e + 1) % 3] - triangle[e];
    away -= edge * (away.dot(edge) / edge.squaredNorm());
    away.normalize();
  }
  return away;
}

}  // namespace

void hold_still(HalfSpaceBuffer& planes) noexcept {
  planes.clear();
  for (int axis = 0; axis < 3; ++axis) {
    planes.push({Vec3::Unit(axis), 0.0, no_triangle});
    planes.push({-Vec3::Unit(axis), 0.0, no_triangle});
  }
}

/// The arguments, and the lengths that follow from them. All [length].
struct FreePolytope::Query {
  Vec3 tip;
  double radius;
  double clearance;
  double kept = 0.0;      // distance that the planes keep
  double reach = 0.0;     // triangles farther away cannot come within that distance
  double rounding = 0.0;  // of the guarantee; half of it is for the arithmetic

  /// Returns the least offset of a plane with this normal that keeps the triangle at the distance
  /// `kept`; at least -radius, where the plane touches the ball.
  double least_offset(const TriangleFromTip& triangle, const Vec3& normal) const noexcept {
    return std::max(support_within(triangle, normal, reach, 0.25 * rounding) + kept, -radius);
  }

  /// Returns the plane with this normal that keeps the triangle at that distance, if it allows
  /// standing still.
  std::optional<HalfSpace> plane(const TriangleFromTip& triangle, const Vec3& normal,
                                 TriangleId source) const noexcept {
    const double least = least_offset(triangle, normal);
    if (!(least <= 0.5 * rounding)) return std::nullopt;
    const double standoff = std::min(standoff_of_radius * radius, -standoff_of_room * least);
    return HalfSpace{normal, std::min(least + std::max(standoff, 0.5 * rounding), 0.0), source};
  }

  /// Returns true if the plane also keeps the triangle at that distance. A plane through the tip
  /// has no standoff. There, a triangle that is coplanar up to rounding counts as behind the plane.
  bool is_behind(const TriangleFromTip& triangle, const Vec3& closest,
                 const HalfSpace& plane) const noexcept {
    const double limit = plane.offset < 0.0 ? plane.offset : 0.5 * rounding;
    if (plane.normal.dot(closest) + kept > limit) return false;
    return least_offset(triangle, plane.normal) <= limit;
  }
};

FreePolytope::FreePolytope(std::shared_ptr<const Mesh> mesh, std::size_t triangles)
    : mesh_(std::move(mesh)), probes_(points_in_unit_ball<probe_count>()) {
  if (mesh_ == nullptr) throw Error("a free polytope needs a mesh");
  // There are at most as many hits as triangles, so a huge capacity costs nothing.
  turns_.resize(std::min(triangles, mesh_->triangle_count()));
}

Status FreePolytope::around(const Vec3& tip, double radius, double clearance,
                            std::span<const Hit> hits, Budget& budget,
                            HalfSpaceBuffer& planes) noexcept {
  planes.clear();
  Query query{.tip = tip, .radius = radius, .clearance = clearance};
  Status status = prepare(query, hits);
  if (status == Status::free) status = separate(query, hits, budget, planes);
  if (status != Status::free) hold_still(planes);
  return status;
}

Status FreePolytope::prepare(Query& query, std::span<const Hit> hits) const noexcept {
  if (!(query.tip.array().abs() <= longest_length).all() || !is_length(query.radius) ||
      !is_length(query.clearance)) {
    return Status::invalid_input;
  }
  if (hits.size() > turns_.size()) return Status::over_capacity;
  double nearest = longest_length;
  double size2 = 0.0;
  for (const Hit& hit : hits) {
    if (hit.triangle >= mesh_->triangle_count() || !is_length(hit.closest.distance)) {
      return Status::invalid_input;
    }
    nearest = std::min(nearest, hit.closest.distance);
    for (const VertexId v : mesh_->corners(hit.triangle)) {
      size2 = std::max(size2, (mesh_->vertex(v) - query.tip).squaredNorm());
    }
  }
  query.rounding = 1e-12 * query.radius + 2e-14 * std::sqrt(size2);
  if (nearest <= query.rounding) return Status::touching;
  // At the clearance up to rounding, the planes keep the clearance itself, so that losses do not
  // add up over the steps.
  query.kept = nearest >= query.clearance - 0.25 * query.rounding ? query.clearance : nearest;
  query.reach = query.radius + query.kept;
  return Status::free;
}

std::span<const FreePolytope::Turn> FreePolytope::by_distance(std::span<const Hit> hits) noexcept {
  const std::span<Turn> turns(turns_.data(), hits.size());
  for (std::uint32_t i = 0; i < turns.size(); ++i) {
    const auto& corner = corner_order(mesh_->triangle(hits[i].triangle)).corner;
    turns[i] = {hits[i].closest.distance, i, {}};
    std::copy(corner.begin(), corner.end(), turns[i].corner.begin());
  }
  std::sort(turns.begin(), turns.end(), [&](const Turn& a, const Turn& b) {
    if (a.distance != b.distance) return a.distance < b.distance;
    // As comes_before(), which would order the corners for each comparison.
    const std::array<VertexId, 3>& mine = mesh_->corners(hits[a.hit].triangle);
    const std::array<VertexId, 3>& theirs = mesh_->corners(hits[b.hit].triangle);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& one = mesh_->vertex(mine[a.corner[c]]);
      const Vec3& other = mesh_->vertex(theirs[b.corner[c]]);
      for (int axis = 0; axis < 3; ++axis) {
        if (one[axis] != other[axis]) return one[axis] < other[axis];
      }
    }
    return a.hit < b.hit;
  });
  return turns;
}

Status FreePolytope::separate(const Query& query, std::span<const Hit> hits, Budget& budget,
                              HalfSpaceBuffer& planes) noexcept {
  budget.spend(hits.size() * work::polytope_hit);
  if (budget.is_spent()) return Status::out_of_budget;
  is_left_.fill(true);
  std::size_t latest = 0;  // neighbors tend to be behind the same plane
  for (const Turn& turn : by_distance(hits)) {
    if (turn.distance > query.reach) break;
    if (budget.is_spent()) return Status::out_of_budget;
    const Hit& hit = hits[turn.hit];
    const TriangleFromTip seen = triangle_from_tip(mesh_->triangle(hit.triangle), query.tip);
    const auto is_behind = [&](const HalfSpace& plane) {
      return query.is_behind(seen, hit.closest.offset, plane);
    };
    if (latest < planes.size() && is_behind(planes[latest])) continue;
    const HalfSpace* const behind = std::find_if(planes.begin(), planes.end(), is_behind);
    latest = static_cast<std::size_t>(behind - planes.begin());
    budget.spend(latest * work::polytope_test);
    if (behind != planes.end()) continue;

    const std::optional<HalfSpace> plane = plane_for(query, hit, seen);
    budget.spend(work::polytope_plane);
    if (!plane) return Status::touching;
    if (planes.size() == planes.capacity()) return Status::over_capacity;
    planes.push(*plane);
    remove_probes(*plane, query.radius);
  }
  return Status::free;
}

std::optional<HalfSpace> FreePolytope::plane_for(const Query& query, const Hit& hit,
                                                 const TriangleFromTip& seen) const noexcept {
  const bool is_behind_it = seen.normal.dot(seen.corners[0]) > 0.0;
  const Vec3 facing = is_behind_it ? -seen.normal : seen.normal;
  std::optional<HalfSpace> face;
  if (!facing.isZero(0.0)) face = query.plane(seen, facing, hit.triangle);
  if (face && is_face(hit.closest.feature)) return face;  // the other is the same, but less exact

  const Vec3 away = away_from(hit.closest, mesh_->triangle(hit.triangle));
  const std::optional<HalfSpace> across = query.plane(seen, away, hit.triangle);
  if (!face || !across) return face ? face : across;
  return probes_left_by(*face, query.radius) > probes_left_by(*across, query.radius) ? face
                                                                                     : across;
}

std::size_t FreePolytope::probes_left_by(const HalfSpace& plane, double radius) const noexcept {
  std::size_t left = 0;
  for (std::size_t i = 0; i < probe_count; ++i) {
    if (is_left_[i] && plane.normal.dot(probes_[i]) * radius >= plane.offset) ++left;
  }
  return left;
}

void FreePolytope::remove_probes(const HalfSpace& plane, double radius) noexcept {
  for (std::size_t i = 0; i < probe_count; ++i) {
    if (plane.normal.dot(probes_[i]) * radius < plane.offset) is_left_[i] = false;
  }
}

}  // namespace keepout
