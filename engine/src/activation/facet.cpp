// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/facet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../geometry/corner_order.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {
namespace {

// Budgets of work, far above what was ever seen (12 and 9): beyond them the answer is the safe one.
constexpr int most_cuts = 40;
constexpr int most_newton_steps = 48;

/// A lower bound of the distance along a motion, less a level: `at_0` + t `slope`.
struct Line {
  double at_0;
  double slope;

  double at(double t) const noexcept { return at_0 + t * slope; }
};

Line line_of(const Vec3& n, const Facet& facet, const Vec3& z, double level) noexcept {
  return {-facet.support(n) - level, n.dot(z)};
}

bool holds(const Line& line, double slack) noexcept {
  return line.at_0 >= -slack && line.at(1.0) >= -slack;
}

/// Zero when there is no direction.
Vec3 unit(const Vec3& v) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3::Zero();
}

HalfSpace plane_along(const Vec3& n, const Facet& facet, double level) noexcept {
  return {n, facet.support(n) + level, facet.source()};
}

/// How long until a motion along z comes within `level` of what it is `away` from; 0 if it does
/// not.
double time_until(const Vec3& away, const Vec3& z, double level) noexcept {
  // |away + t z| = level, the earlier of the two.
  const double falling = -away.dot(z);
  const double missing = away.squaredNorm() - level * level;
  const double square = falling * falling - z.squaredNorm() * missing;
  if (!(falling > 0.0 && missing > 0.0 && square >= 0.0)) return 0.0;
  return missing / (falling + std::sqrt(square));
}

/// What of v is across an edge: as of an edge of any other facet that shares it, bit for bit.
Vec3 across_edge(const Vec3& v, const Vec3& along) noexcept {
  return v - along * (along.dot(v) / along.squaredNorm());
}

/// The same from a point that is `away` from the closest corner, or the closest side's line.
double time_until(const Vec3& away, const Vec3& z, const Facet& facet, Feature feature,
                  double level) noexcept {
  if (is_face(feature)) return 0.0;
  if (is_vertex(feature)) return time_until(away, z, level);
  return time_until(away, across_edge(z, facet.edge(number_of(feature))), level);
}

/// The same from the tip, by the corner or side alone, so that all facets that share it agree to
/// the last bit on when it is met: then their corners decide which was first, and not rounding.
double time_from_tip(const Vec3& z, const Facet& facet, Feature feature, double level) noexcept {
  if (is_face(feature)) return 0.0;
  const int number = number_of(feature);
  if (is_vertex(feature)) return time_until(-facet.corners()[number], z, level);
  const Vec3 along = facet.edge(number);
  const Vec3& first = facet.corners()[number == 2 ? 0 : number];
  return time_until(-across_edge(first, along), across_edge(z, along), level);
}

/// Of all blends of a falling and a rising normal, the one that is level along the motion.
Vec3 level_blend(const Vec3& falling, double fall, const Vec3& rising, double rise) noexcept {
  return unit(rise * falling - fall * rising);
}

}  // namespace

Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept {
  const CornerOrder order = corner_order(triangle);
  return {triangle[order.corner[0]] - tip, triangle[order.corner[1]] - tip,
          triangle[order.corner[2]] - tip};
}

Facet::Facet(const Triangle& triangle, const Vec3& tip, TriangleId source) noexcept
    : Facet(ordered_relative(triangle, tip), source) {}

Facet::Facet(const Triangle& ordered, TriangleId source) noexcept
    : corners_(ordered), source_(source) {
  normal_ = normal_at(Vec3::Zero(), distance_, feature_);
}

Vec3 Facet::normal_at(const Vec3& point, double& distance, Feature& feature) const noexcept {
  const ClosestPoint closest = closest_point_of_ordered(corners_, point);
  distance = closest.distance;
  feature = closest.feature;
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
  // A direction is known only to the root of a rounding where two features are about equally near,
  // and worse close to the facet and on a needle. Of all that it could be, what proves the most.
  constexpr double tight = 1.0 - 1e-12;
  if (most >= tight * distance) return best;
  consider(facing(closest));
  for (int edge = 0; edge < 3; ++edge) consider(across(away, edge));
  return best;
}

/// On either side, for the order of the corners does not tell; zero without an area.
Vec3 Facet::plane_normal() const noexcept {
  return unit((corners_[1] - corners_[0]).cross(corners_[2] - corners_[0]));
}

/// The facet's own normal, on the side from which its closest point was found.
Vec3 Facet::facing(const ClosestPoint& closest) const noexcept {
  const Vec3 normal = plane_normal();
  return normal.dot(closest.offset) <= 0.0 ? normal : Vec3(-normal);
}

/// A direction made perpendicular to an edge: along it, a rounding would tell over its whole
/// length.
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

std::optional<Vec3> proof_of_clearance(const Facet& facet, const Vec3& z, double level,
                                       double slack) noexcept {
  Vec3 n_left = facet.normal();
  Line left = line_of(n_left, facet, z, level);
  if (holds(left, slack)) return n_left;

  double distance = 0.0;
  Vec3 n_right = facet.normal_at(z, distance);
  if (!(distance - level >= -slack)) return std::nullopt;
  Line right = line_of(n_right, facet, z, level);
  if (holds(right, slack)) return n_right;
  // A distance that never falls, or always does, is least at an end, and was proven there: but for
  // a rounding, and then no is the safe answer.
  if (!(left.slope < 0.0 && right.slope > 0.0)) return std::nullopt;

  // In between the two lines bound the least distance from below, where they cross. So does the
  // blend of their normals, and better; it is exact where both look at the same corner or edge.
  for (int cut = 0; cut < most_cuts; ++cut) {
    const Vec3 blend = level_blend(n_left, left.slope, n_right, right.slope);
    if (separates(blend, facet.corners(), z, level, slack)) return blend;
    const double t = (left.at_0 - right.at_0) / (right.slope - left.slope);
    const Vec3 n = facet.normal_at(t * z, distance);
    if (!(distance - level >= -slack)) return std::nullopt;
    const Line line = line_of(n, facet, z, level);
    if (holds(line, slack)) return n;
    if (line.slope < 0.0) {
      n_left = n;
      left = line;
    } else {
      n_right = n;
      right = line;
    }
  }
  return std::nullopt;
}

Contact first_contact(const Facet& facet, const Vec3& z, double level, double slack,
                      double latest) noexcept {
  Vec3 n = facet.normal();
  double distance = facet.distance();
  Feature feature = facet.feature();
  double time = 0.0;
  // What is given up is later than `latest` by more than the last digits can make up for.
  const double digits = slack / z.norm();
  const double too_late = latest + digits;
  for (int i = 0; i < most_newton_steps; ++i) {
    const Line line = line_of(n, facet, z, level);
    if (!(line.slope < 0.0)) break;
    const double last = time;
    time = -line.at_0 / line.slope;
    // Later than `latest` shall mean later at the end as well, whatever rounding does.
    if (i > 0) time = std::max(time, last);
    if (distance - level <= slack) {
      const double direct = time_from_tip(z, facet, feature, level);
      if (direct > 0.0 && std::abs(direct - time) <= digits) time = direct;
      return {time, plane_along(n, facet, level), true, last * z - distance * n};
    }
    // Too late, or as far as numbers go.
    if (time > too_late || !(time > last && time < 1.0)) break;
    const double leap = last + time_until(distance * n, z, facet, feature, level + 0.5 * slack);
    if (leap > time && leap < 1.0) {
      double there = 0.0;
      Feature at_leap;
      const Vec3 normal = facet.normal_at(leap * z, there, at_leap);
      if (there >= level && normal.dot(z) < 0.0) {
        n = normal;
        distance = there;
        feature = at_leap;
        time = leap;
        continue;
      }
    }
    n = facet.normal_at(time * z, distance, feature);
  }
  return {time, plane_along(n, facet, level)};
}

}  // namespace keepout
