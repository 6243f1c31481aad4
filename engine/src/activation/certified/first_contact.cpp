// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/first_contact.h"

#include <algorithm>
#include <cmath>

#include "distance_bound.h"

namespace keepout {
namespace {

// A budget of work, far above what was ever seen (9): beyond it the answer is the safe one.
constexpr int most_newton_steps = 48;

HalfSpace plane_of(const Facet::Nearest& nearest, const Facet& facet, double level) noexcept {
  return {nearest.normal, nearest.support + level, facet.source()};
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

}  // namespace

Contact first_contact(const Facet& facet, const Vec3& z, double level, double slack,
                      double latest) noexcept {
  Facet::Nearest nearest = facet.at_tip();
  double time = 0.0;
  // What is given up is later than `latest` by more than the last digits can make up for.
  const double digits = slack / z.norm();
  const double too_late = latest + digits;
  for (int i = 0; i < most_newton_steps; ++i) {
    const Line line = line_of(nearest, z, level);
    if (!(line.slope < 0.0)) break;
    const double last = time;
    time = -line.at_0 / line.slope;
    // Later than `latest` shall mean later at the end as well, whatever rounding does.
    if (i > 0) time = std::max(time, last);
    if (nearest.distance - level <= slack) {
      const double direct = time_from_tip(z, facet, nearest.feature, level);
      if (direct > 0.0 && std::abs(direct - time) <= digits) time = direct;
      return {time, plane_of(nearest, facet, level), true,
              last * z - nearest.distance * nearest.normal};
    }
    // Too late, or as far as numbers go.
    if (time > too_late || !(time > last && time < 1.0)) break;
    if (is_face(nearest.feature)) {
      // It is met where its plane is, if that is where the face is.
      if (facet.is_under(time * z)) {
        return {time, plane_of(nearest, facet, level), true, time * z - level * nearest.normal};
      }
    } else {
      if (i == 0 && facet.has_face()) {
        // The face's plane is not met later than the facet. It is met there, or on the way on.
        const Facet::Nearest face = facet.face();
        const Line fall = line_of(face, z, level);
        if (fall.at_0 > 0.0 && fall.slope < 0.0) {
          const double meets = -fall.at_0 / fall.slope;
          if (meets > too_late || !(meets < 1.0)) return {meets, plane_of(face, facet, level)};
          if (facet.is_under(meets * z)) {
            return {meets, plane_of(face, facet, level), true, meets * z - level * face.normal};
          }
          time = std::max(time, meets);
        }
      }
      const double leap = last + time_until(nearest.distance * nearest.normal, z, facet,
                                            nearest.feature, level + 0.5 * slack);
      if (leap > time && leap < 1.0) {
        const Facet::Nearest there = facet.nearest_to(leap * z, nearest.feature);
        if (there.distance >= level && there.normal.dot(z) < 0.0) {
          nearest = there;
          time = leap;
          continue;
        }
      }
    }
    nearest = facet.nearest_to(time * z);
  }
  return {time, plane_of(nearest, facet, level)};
}

}  // namespace keepout
