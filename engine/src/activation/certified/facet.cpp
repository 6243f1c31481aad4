// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/facet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../../geometry/corner_order.h"
#include "../../geometry/direction_of.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {

Facet::Facet(const Triangle& triangle, const Vec3& tip, TriangleId source) noexcept
    : Facet(ordered_relative(triangle, tip), source) {}

Facet::Facet(const Triangle& ordered, TriangleId source) noexcept
    : corners_(ordered), source_(source) {
  const Vec3 first = corners_[1] - corners_[0];
  const Vec3 last = corners_[2] - corners_[0];
  const Vec3 normal = first.cross(last);
  const double area2 = normal.squaredNorm();
  first2_ = first.squaredNorm();
  last2_ = last.squaredNorm();
  between_ = first.dot(last);
  const double longest2 = std::max({first2_, last2_, first2_ - 2.0 * between_ + last2_});
  // For a thinner triangle barycentric coordinates are not exact enough.
  constexpr double thin = 1e-2;  // height, in lengths of the longest edge
  if (area2 > thin * thin * longest2 * longest2) {
    determinant_ = first2_ * last2_ - between_ * between_;
    plane_normal_ = normal / std::sqrt(area2);
  } else {
    plane_normal_.setZero();
  }
  at_tip_ = nearest_to(Vec3::Zero());
}

inline Facet::Shares Facet::shares(const Vec3& point) const noexcept {
  const Vec3 off = point - corners_[0];
  const double along_first = off.dot(corners_[1] - corners_[0]);
  const double along_last = off.dot(corners_[2] - corners_[0]);
  return {along_first, along_last, last2_ * along_first - between_ * along_last,
          first2_ * along_last - between_ * along_first};
}

// A direction is known only to the root of a rounding if two features are about equally near, and
// worse close to the facet and on a needle. A normal that proves less than this of a distance is
// not taken before all candidates were tried (nearest_with_care).
constexpr double tight = 1.0 - 1e-12;

/// Fills `nearest` for the vector `off`, `distance` long, from a point of the facet to `point`.
/// Returns true if its normal proves that distance, so that no other point is closer.
inline bool Facet::is_nearest(const Vec3& point, const Vec3& off, double distance, Feature feature,
                              Nearest& nearest) const noexcept {
  nearest.normal = off / distance;
  nearest.distance = distance;
  nearest.support = support(nearest.normal);
  nearest.feature = feature;
  return nearest.normal.dot(point) - nearest.support >= tight * distance;
}

/// Precondition: the point is right over the face.
inline bool Facet::face_is_nearest(const Vec3& point, Nearest& nearest) const noexcept {
  const double height = plane_normal_.dot(point - corners_[0]);
  nearest.normal = height < 0.0 ? Vec3(-plane_normal_) : plane_normal_;
  nearest.distance = std::abs(height);
  nearest.support = support(nearest.normal);
  nearest.feature = Feature::face;
  return nearest.normal.dot(point) - nearest.support >= tight * nearest.distance;
}

inline bool Facet::edge_is_nearest(const Vec3& point, int edge, Nearest& nearest) const noexcept {
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

inline bool Facet::corner_is_nearest(const Vec3& point, int corner,
                                     Nearest& nearest) const noexcept {
  const Vec3 off = point - corners_[corner];
  return is_nearest(point, off, off.norm(),
                    static_cast<Feature>(static_cast<int>(Feature::vertex_0) + corner), nearest);
}

bool Facet::is_under(const Vec3& point) const noexcept {
  return shares(point).are_inside(determinant_);
}

Facet::Nearest Facet::face() const noexcept {
  Nearest nearest;
  face_is_nearest(Vec3::Zero(), nearest);
  return nearest;
}

Facet::Nearest Facet::nearest_to(const Vec3& point) const noexcept {
  Nearest nearest;
  const Shares at = shares(point);
  bool found = false;
  // The region of the point, by its barycentric coordinates and its feet on the edges: first from
  // corner 0 to 1, second from 1 to 2, last from 0 to 2. Face: all coordinates are positive. Edge:
  // the coordinate of the opposite corner is not, and the foot is on the edge. Else a corner.
  if (at.are_inside(determinant_)) {
    found = face_is_nearest(point, nearest);
  } else if (determinant_ > 0.0) {
    const double along_second = (at.along_last - between_) - (at.along_first - first2_);
    const double second2 = (first2_ - between_) + (last2_ - between_);
    const unsigned first = unsigned{at.of_third <= 0.0} & unsigned{at.along_first > 0.0} &
                           unsigned{at.along_first < first2_};
    const unsigned second = unsigned{at.of_second + at.of_third >= determinant_} &
                            unsigned{along_second > 0.0} & unsigned{along_second < second2};
    const unsigned last = unsigned{at.of_second <= 0.0} & unsigned{at.along_last > 0.0} &
                          unsigned{at.along_last < last2_};
    if ((first | second | last) != 0) {
      found = edge_is_nearest(point, first != 0 ? 0 : second != 0 ? 1 : 2, nearest);
    } else {
      const bool is_first = at.along_first <= 0.0 && at.along_last <= 0.0;
      const bool is_second = along_second <= 0.0;
      found = corner_is_nearest(point, is_first ? 0 : is_second ? 1 : 2, nearest);
    }
  }
  return found ? nearest : nearest_with_care(point);
}

Facet::Nearest Facet::nearest_to(const Vec3& point, Feature likely) const noexcept {
  Nearest nearest;
  if (is_edge(likely) && edge_is_nearest(point, number_of(likely), nearest)) return nearest;
  if (is_vertex(likely) && corner_is_nearest(point, number_of(likely), nearest)) return nearest;
  return nearest_to(point);
}

Facet::Nearest Facet::nearest_with_care(const Vec3& point) const noexcept {
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
  if (is_face(closest.feature)) consider(facing(closest));
  if (!(most >= tight * closest.distance)) {
    consider(facing(closest));
    for (int edge = 0; edge < 3; ++edge) consider(across(away, edge));
  }
  return {best, closest.distance, support(best), closest.feature};
}

/// Returns the unit normal on an arbitrary side; zero without an area.
Vec3 Facet::plane_normal() const noexcept {
  return unit((corners_[1] - corners_[0]).cross(corners_[2] - corners_[0]));
}

/// Returns the facet's own normal, on the side from which its closest point was found.
Vec3 Facet::facing(const ClosestPoint& closest) const noexcept {
  const Vec3 normal = plane_normal();
  return normal.dot(closest.offset) <= 0.0 ? normal : Vec3(-normal);
}

/// Returns a direction made perpendicular to an edge: rounding along the edge would count over its
/// whole length.
Vec3 Facet::across(const Vec3& n, int edge) const noexcept {
  const Vec3 along = this->edge(edge);
  const double length2 = along.squaredNorm();
  if (!(length2 > 0.0)) return n;
  return unit(n - along * (n.dot(along) / length2));
}

Vec3 Facet::face_normal() const noexcept {
  const Vec3 normal = plane_normal();
  return normal.dot(corners_[0]) <= 0.0 ? normal : Vec3(-normal);
}

Vec3 Facet::normal_around(int edge, double level) const noexcept {
  const Vec3& from = corners_[edge];
  const Vec3 along = (corners_[(edge + 1) % 3] - from).normalized();
  if (!along.allFinite()) return Vec3::Zero();
  // Seen along the edge: a circle of radius `level`, and its tangents through the tip.
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

bool Facet::before(const Facet& other) const noexcept {
  return comes_before(corners_, other.corners_);
}

}  // namespace keepout
