// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/first_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "straight_clearance.h"

namespace keepout {
namespace {

// Far above the most seen, 9. A time after the last step is before the contact, which is safe.
constexpr int most_newton_steps = 48;

HalfSpace plane_of(const PreparedTriangle::Nearest& nearest, const PreparedTriangle& prepared,
                   double level) noexcept {
  return {nearest.normal, nearest.support + level, prepared.triangle()};
}

/// Returns the time until a motion along z comes within `level` of a point; 0, which is no leap, if
/// it does not. `away`: from the point to the start.
double time_until(const Vec3& away, const Vec3& z, double level) noexcept {
  // The earlier solution of |away + t z| = level.
  const double falling = -away.dot(z);
  const double missing = away.squaredNorm() - level * level;
  const double square = falling * falling - z.squaredNorm() * missing;
  if (!(falling > 0.0 && missing > 0.0 && square >= 0.0)) return 0.0;
  return missing / (falling + std::sqrt(square));
}

/// Returns the part of v across an edge, bitwise identical for all prepared triangles that share
/// the edge.
Vec3 across_edge(const Vec3& v, const Vec3& along) noexcept {
  return v - along * (along.dot(v) / along.squaredNorm());
}

/// Returns the time until a motion along z comes within `level` of a corner of a prepared triangle,
/// or of the line of an edge. Returns 0 for the face, or if it does not come so close. `away`: from
/// the corner, or across the edge from its line, to the start.
double time_until(const Vec3& away, const Vec3& z, const PreparedTriangle& prepared,
                  Feature feature, double level) noexcept {
  if (is_face(feature)) return 0.0;
  if (is_vertex(feature)) return time_until(away, z, level);
  return time_until(away, across_edge(z, prepared.edge(number_of(feature))), level);
}

/// Returns the vector from a prepared triangle's corner, or across the line of its edge, to the
/// tip. It depends on corner or edge alone, so times computed from it are bitwise identical for all
/// prepared triangles that share the feature. Their corners then decide which contact is first, and
/// not rounding.
Vec3 from_feature_to_tip(const PreparedTriangle& prepared, Feature feature) noexcept {
  const int number = number_of(feature);
  if (is_vertex(feature)) return -prepared.corners()[number];
  return -across_edge(prepared.corners()[number == 2 ? 0 : number], prepared.edge(number));
}

/// Returns the contact of a motion with the plane of the face, which is no later than the contact
/// with the prepared triangle. It is reached if it is over the face. Returns nothing if the motion
/// does not approach the plane.
std::optional<Contact> contact_of_face_plane(const PreparedTriangle& prepared, const Vec3& z,
                                             double level) noexcept {
  const PreparedTriangle::Nearest nearest = prepared.on_face_plane(Vec3::Zero());
  const Line fall = line_of(nearest, z, level);
  if (!(fall.at_0 > 0.0 && fall.slope < 0.0)) return std::nullopt;
  const double time = -fall.at_0 / fall.slope;
  Contact contact{time, plane_of(nearest, prepared, level)};
  if (prepared.has_above(time * z)) {
    contact.is_reached = true;
    contact.touched = time * z - level * nearest.normal;
  }
  return contact;
}

}  // namespace

Contact first_contact(const PreparedTriangle& prepared, const Vec3& z, double level, double slack,
                      double latest) noexcept {
  PreparedTriangle::Nearest nearest = prepared.at_tip();
  double time = 0.0;
  // A rejected contact is later than `latest` by more than its last digits.
  const double digits = slack / z.norm();
  const double too_late = latest + digits;
  for (int i = 0; i < most_newton_steps; ++i) {
    const Line line = line_of(nearest, z, level);
    if (!(line.slope < 0.0)) break;
    const double last = time;  // the time of `nearest`; `time` is the next
    time = -line.at_0 / line.slope;
    // Rounding must not make a time earlier: a time later than `latest` stays later.
    if (i > 0) time = std::max(time, last);
    if (nearest.distance - level <= slack) {
      const bool is_on_face = is_face(nearest.feature);
      const double direct = is_on_face ? 0.0
                                       : time_until(from_feature_to_tip(prepared, nearest.feature),
                                                    z, prepared, nearest.feature, level);
      if (direct > 0.0 && std::abs(direct - time) <= digits) time = direct;
      return {time, plane_of(nearest, prepared, level), true,
              last * z - nearest.distance * nearest.normal};
    }
    // Too late, or no progress in double.
    if (time > too_late || !(time > last && time < 1.0)) break;
    if (is_face(nearest.feature)) {
      // The contact with the face's plane is the contact if it is over the face.
      if (prepared.has_above(time * z)) {
        return {time, plane_of(nearest, prepared, level), true, time * z - level * nearest.normal};
      }
    } else {
      if (i == 0 && prepared.has_face()) {
        if (const auto plane = contact_of_face_plane(prepared, z, level)) {
          if (plane->time > too_late || !(plane->time < 1.0)) return {plane->time, plane->plane};
          if (plane->is_reached) return *plane;
          time = std::max(time, plane->time);
        }
      }
      // The leap to the contact with the nearest corner or edge, if the prepared triangle is no
      // closer there.
      const double leap = last + time_until(nearest.distance * nearest.normal, z, prepared,
                                            nearest.feature, level + 0.5 * slack);
      if (leap > time && leap < 1.0) {
        const PreparedTriangle::Nearest there = prepared.nearest_to(leap * z, nearest.feature);
        if (there.distance >= level && there.normal.dot(z) < 0.0) {
          nearest = there;
          time = leap;
          continue;
        }
      }
    }
    nearest = prepared.nearest_to(time * z);
  }
  return {time, plane_of(nearest, prepared, level)};
}

}  // namespace keepout
