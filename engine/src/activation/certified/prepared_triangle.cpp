// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/prepared_triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../../geometry/corner_order.h"
#include "../../geometry/direction_of.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {

PreparedTriangle::PreparedTriangle(const Triangle& triangle, const Vec3& tip,
                                   TriangleId number) noexcept
    : PreparedTriangle(ordered_relative(triangle, tip), number) {}

PreparedTriangle::PreparedTriangle(const Triangle& ordered, TriangleId number) noexcept
    : corners_(ordered), triangle_(number) {
  const Vec3 edge_01 = corners_[1] - corners_[0];
  const Vec3 edge_02 = corners_[2] - corners_[0];
  const Vec3 normal = edge_01.cross(edge_02);
  const double area2 = normal.squaredNorm();
  length2_01_ = edge_01.squaredNorm();
  length2_02_ = edge_02.squaredNorm();
  product_ = edge_01.dot(edge_02);
  const double longest2 =
      std::max({length2_01_, length2_02_, length2_01_ - 2.0 * product_ + length2_02_});
  // On a needle (A9 of docs/certified-step.md) barycentric coordinates are not exact enough.
  constexpr double needle = 1e-2;  // height, as a fraction of the longest edge
  if (area2 > needle * needle * longest2 * longest2) {
    determinant_ = length2_01_ * length2_02_ - product_ * product_;
    face_normal_ = normal / std::sqrt(area2);
  } else {
    face_normal_.setZero();
  }
  at_tip_ = nearest_to(Vec3::Zero());
}

inline PreparedTriangle::Shares PreparedTriangle::shares(const Vec3& point) const noexcept {
  const Vec3 off = point - corners_[0];
  const double along_01 = off.dot(corners_[1] - corners_[0]);
  const double along_02 = off.dot(corners_[2] - corners_[0]);
  return {along_01, along_02, length2_02_ * along_01 - product_ * along_02,
          length2_01_ * along_02 - product_ * along_01};
}

// If two features are about equally near, a direction is known only to the root of a rounding; it
// is worse close to the triangle, and on a needle. A normal that proves this fraction of the
// distance is accepted at once. Otherwise nearest_with_care() tries all candidates.
constexpr double tight = 1.0 - 1e-12;

/// Fills `nearest` for the vector `off`, `distance` long, from a point of the prepared triangle to
/// `point`. Returns true if the normal proves that distance, so that no other point is closer.
inline bool PreparedTriangle::is_nearest(const Vec3& point, const Vec3& off, double distance,
                                         Feature feature, Nearest& nearest) const noexcept {
  nearest.normal = off / distance;
  nearest.distance = distance;
  nearest.support = support(nearest.normal);
  nearest.feature = feature;
  return nearest.normal.dot(point) - nearest.support >= tight * distance;
}

inline bool PreparedTriangle::edge_is_nearest(const Vec3& point, int edge,
                                              Nearest& nearest) const noexcept {
  const Vec3& from = corners_[edge == 2 ? 0 : edge];
  const Vec3 along = corners_[edge == 0 ? 1 : 2] - from;
  const Vec3 off = point - from;
  const double share = off.dot(along);
  const double length2 = along.squaredNorm();
  if (!(share > 0.0 && share < length2)) return false;
  const Vec3 straight = off - along * (share / length2);
  return is_nearest(point, straight, straight.norm(),
                    static_cast<Feature>(static_cast<int>(Feature::edge_0) + edge), nearest);
}

inline bool PreparedTriangle::corner_is_nearest(const Vec3& point, int corner,
                                                Nearest& nearest) const noexcept {
  const Vec3 off = point - corners_[corner];
  return is_nearest(point, off, off.norm(),
                    static_cast<Feature>(static_cast<int>(Feature::vertex_0) + corner), nearest);
}

bool PreparedTriangle::has_above(const Vec3& point) const noexcept {
  return shares(point).are_inside(determinant_);
}

PreparedTriangle::Nearest PreparedTriangle::on_face_plane(const Vec3& point) const noexcept {
  const double height = face_normal_.dot(point - corners_[0]);
  const Vec3 normal = height < 0.0 ? Vec3(-face_normal_) : face_normal_;
  return {normal, std::abs(height), support(normal), Feature::face};
}

PreparedTriangle::Nearest PreparedTriangle::nearest_to(const Vec3& point) const noexcept {
  Nearest nearest;
  const Shares at = shares(point);
  bool found = false;
  // The barycentric coordinates and the feet on the edges give the region of the point. Face: all
  // coordinates are positive. Edge: the coordinate of the opposite corner is not positive, and the
  // foot is on the edge. Otherwise a corner.
  if (at.are_inside(determinant_)) {
    nearest = on_face_plane(point);
    found = nearest.normal.dot(point) - nearest.support >= tight * nearest.distance;
  } else if (determinant_ > 0.0) {
    const double along_12 = (at.along_02 - product_) - (at.along_01 - length2_01_);
    const double length2_12 = (length2_01_ - product_) + (length2_02_ - product_);
    const unsigned on_01 = unsigned{at.of_2 <= 0.0} & unsigned{at.along_01 > 0.0} &
                           unsigned{at.along_01 < length2_01_};
    const unsigned on_12 = unsigned{at.of_1 + at.of_2 >= determinant_} & unsigned{along_12 > 0.0} &
                           unsigned{along_12 < length2_12};
    const unsigned on_02 = unsigned{at.of_1 <= 0.0} & unsigned{at.along_02 > 0.0} &
                           unsigned{at.along_02 < length2_02_};
    if ((on_01 | on_12 | on_02) != 0) {
      found = edge_is_nearest(point, on_01 != 0 ? 0 : on_12 != 0 ? 1 : 2, nearest);
    } else {
      const bool at_0 = at.along_01 <= 0.0 && at.along_02 <= 0.0;
      const bool at_1 = along_12 <= 0.0;
      found = corner_is_nearest(point, at_0 ? 0 : at_1 ? 1 : 2, nearest);
    }
  }
  return found ? nearest : nearest_with_care(point);
}

PreparedTriangle::Nearest PreparedTriangle::nearest_to(const Vec3& point,
                                                       Feature likely) const noexcept {
  Nearest nearest;
  if (is_edge(likely) && edge_is_nearest(point, number_of(likely), nearest)) return nearest;
  if (is_vertex(likely) && corner_is_nearest(point, number_of(likely), nearest)) return nearest;
  return nearest_to(point);
}

/// Like nearest_to(), for needles and where rounding hides the direction: tries all normals that
/// may prove the distance.
PreparedTriangle::Nearest PreparedTriangle::nearest_with_care(const Vec3& point) const noexcept {
  const ClosestPoint closest = closest_point_of_ordered(corners_, point);
  const Vec3 away = unit(-closest.offset);
  const auto proven = [&](const Vec3& n) { return n.dot(point) - support(n); };
  Vec3 best = is_edge(closest.feature) ? across(away, number_of(closest.feature)) : away;
  double most = proven(best);
  const auto consider = [&](const Vec3& n) {
    const double proves = proven(n);
    if (!(proves > most)) return;
    best = n;
    most = proves;
  };
  const bool is_on_face = is_face(closest.feature);
  if (is_on_face) consider(normal_against(closest.offset));
  if (!(most >= tight * closest.distance)) {
    if (!is_on_face) consider(normal_against(closest.offset));
    for (int edge = 0; edge < 3; ++edge) consider(across(away, edge));
  }
  return {best, closest.distance, support(best), closest.feature};
}

Vec3 PreparedTriangle::normal_against(const Vec3& direction) const noexcept {
  const Vec3 normal = unit((corners_[1] - corners_[0]).cross(corners_[2] - corners_[0]));
  return normal.dot(direction) <= 0.0 ? normal : Vec3(-normal);
}

/// Returns the direction made perpendicular to an edge, because an error along the edge would grow
/// with the edge's length.
Vec3 PreparedTriangle::across(const Vec3& n, int edge) const noexcept {
  const Vec3 along = this->edge(edge);
  const double length2 = along.squaredNorm();
  if (!(length2 > 0.0)) return n;
  return unit(n - along * (n.dot(along) / length2));
}

Vec3 PreparedTriangle::normal_around(int edge, double level) const noexcept {
  const Vec3& from = corners_[edge];
  const Vec3 along = (corners_[(edge + 1) % 3] - from).normalized();
  if (!along.allFinite()) return Vec3::Zero();
  // Seen along the edge: the tangents through the tip to a circle of radius `level`.
  const Vec3 foot = from - along.dot(from) * along;
  const double distance = foot.norm();
  if (!(distance > level)) return Vec3::Zero();
  const Vec3 away = -foot / distance;
  const Vec3 across = along.cross(away);
  const double sine = level / distance;
  const double cosine = std::sqrt(1.0 - sine * sine);
  for (const double side : {1.0, -1.0}) {
    const Vec3 n = (sine * away + side * cosine * across).normalized();
    if (support(n) <= -level * (1.0 - 1e-12)) return n;
  }
  return Vec3::Zero();
}

bool PreparedTriangle::before(const PreparedTriangle& other) const noexcept {
  return comes_before(corners_, other.corners_);
}

}  // namespace keepout
