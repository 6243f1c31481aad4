// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/prepared_triangle.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The place and time at which a motion first comes within `level` of a prepared triangle.
struct Contact {
  /// Fraction t of the motion; negative if the prepared triangle is already closer. If the motion
  /// meets a corner or an edge, t is computed from that feature alone. So the search finds the
  /// earliest of several almost simultaneous contacts. If is_reached is false, t is a lower bound:
  /// 0 if the motion does not approach.
  double time;
  /// The plane that has the prepared triangle, grown by `level`, behind it. The plane allows zero
  /// motion unless the triangle is already closer.
  HalfSpace plane;
  bool is_reached = false;  // false: later than `latest` or the end, or hidden by rounding
  /// The contact point on the prepared triangle, to within the square root of a rounding; only if
  /// is_reached. [length]
  Vec3 touched = Vec3::Zero();
};

/// Returns the first contact of a motion z from the tip, or, without a contact, a lower bound of
/// its time. Runs Newton's method on the distance, from an earlier time. The distance is convex, so
/// no iterate is later than the contact (Lemma 6 of docs/certified-step.md). While the same corner
/// or edge stays nearest, one iteration finds the contact with it. If the contact is surely later
/// than `latest`, returns early with a time after `latest`. `slack`: a distance of up to level +
/// slack counts as contact. [length]
Contact first_contact(const PreparedTriangle& prepared, const Vec3& z, double level, double slack,
                      double latest) noexcept;

}  // namespace keepout
