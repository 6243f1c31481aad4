// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/prepared_triangle.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The place and time at which a motion first comes within `level` of a prepared triangle.
struct Contact {
  /// Fraction t of the motion; negative if the prepared triangle is already closer. If the motion
  /// meets a corner or an edge, t is computed from that feature alone. So the earliest of several
  /// almost simultaneous contacts is found. If not is_reached, t is a lower bound: 0 if the motion
  /// does not approach.
  double time;
  /// The plane that the prepared triangle, grown by `level`, lies behind. It allows 0 unless the
  /// triangle is already closer.
  HalfSpace plane;
  bool is_reached = false;  // false: after `latest` or the end, or hidden by rounding
  /// The contact point on the prepared triangle, to within the square root of a rounding; only if
  /// is_reached. [length]
  Vec3 touched = Vec3::Zero();
};

/// Returns the first contact of a motion z from the tip, or, without a contact, a lower bound of
/// its time. Runs Newton's method from the left on the convex distance, which never goes past the
/// contact (Lemma 6 of docs/certified-step.md). While the same corner or edge stays nearest, one
/// iteration finds the contact with it. Returns as soon as the contact is known to be later than
/// `latest`, with a time after `latest`. `slack`: distance from the level that counts as contact.
/// [length]
Contact first_contact(const PreparedTriangle& prepared, const Vec3& z, double level, double slack,
                      double latest) noexcept;

}  // namespace keepout
