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

/// Of all blends of a falling and a rising normal, the one that is level along the motion.
Vec3 level_blend(const Vec3& falling, double fall, const Vec3& rising, double rise) noexcept {
  return unit(rise * falling - fall * rising);
}

}  // namespace

Facet::Facet(const Triangle& triangle, const Vec3& tip, TriangleId source) noexcept
    : source_(source) {
  const Triangle relative{triangle[0] - tip, triangle[1] - tip, triangle[2] - tip};
  const CornerOrder order = corner_order(relative);
  for (int i = 0; i < 3; ++i) corners_[i] = relative[order.corner[i]];
  normal_ = normal_at(Vec3::Zero(), distance_);
}

Vec3 Facet::normal_at(const Vec3& point, double& distance) const noexcept {
  const ClosestPoint closest = closest_point(corners_, point);
  distance = closest.distance;
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

/// The facet's own normal, on the side from which its closest point was found.
Vec3 Facet::facing(const ClosestPoint& closest) const noexcept {
  const Vec3 normal = unit_normal(corners_);
  return normal.dot(closest.offset) <= 0.0 ? normal : Vec3(-normal);
}

/// A direction made perpendicular to an edge: along it, a rounding would tell over its whole
/// length.
Vec3 Facet::across(const Vec3& n, int edge) const noexcept {
  const Vec3 along = corners_[(edge + 1) % 3] - corners_[edge];
  const double length2 = along.squaredNorm();
  if (!(length2 > 0.0)) return n;
  return unit(n - along * (n.dot(along) / length2));
}

Vec3 Facet::face_normal() const noexcept {
  const Vec3 normal = unit_normal(corners_);
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

double Facet::support(const Vec3& n) const noexcept {
  return std::max({n.dot(corners_[0]), n.dot(corners_[1]), n.dot(corners_[2])});
}

bool Facet::before(const Facet& other) const noexcept {
  return comes_before(corners_, other.corners_);
}

bool separates(const Vec3& n, const Facet& facet, const Vec3& z, double level,
               double slack) noexcept {
  return holds(line_of(n, facet, z, level), slack);
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
    if (separates(blend, facet, z, level, slack)) return blend;
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
  double time = 0.0;
  for (int i = 0; i < most_newton_steps; ++i) {
    const Line line = line_of(n, facet, z, level);
    if (!(line.slope < 0.0)) break;
    const double last = time;
    time = -line.at_0 / line.slope;
    // Later than `latest` shall mean later at the end as well, whatever rounding does.
    if (i > 0) time = std::max(time, last);
    // Close enough, too late, or as far as numbers go.
    if (distance - level <= slack || time > latest || !(time > last && time < 1.0)) break;
    n = facet.normal_at(time * z, distance);
  }
  return {time, {n, facet.support(n) + level, facet.source()}};
}

}  // namespace keepout
