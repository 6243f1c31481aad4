// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/prepared_triangle.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The place and time at which a motion first comes within `level` of a prepared triangle.
struct Contact {
  /// Fraction t of the motion, negative if the prepared triangle is closer already. Where a corner
  /// or an edge is met, it is computed from that alone, so that the earliest of several almost
  /// simultaneous contacts is found. If not is_reached, a lower bound: 0 if the motion does not
  /// approach.
  double time;
  HalfSpace plane;  // that the prepared triangle, grown by `level`, is behind; allows 0 unless
                    // already closer
  bool is_reached = false;  // false: beyond `latest` or the end, or hidden by rounding
  Vec3 touched =
      Vec3::Zero();  // point of the prepared triangle, to within the root of a rounding; if reached
};

/// Returns the first contact of a motion z from the tip, or, without a contact, a lower bound of
/// its time. Newton's method from the left on the convex distance, which never goes past the
/// contact (Lemma 6 of docs/certified-step.md). Where the nearest corner or edge stays the nearest
/// one, its own contact is the prepared triangle's, and is found in one leap. Returns as soon as
/// the contact is known to be later than `latest`, with a time after that. `slack`: distance from
/// the level that counts as contact. [length]
Contact first_contact(const PreparedTriangle& prepared, const Vec3& z, double level, double slack,
                      double latest) noexcept;

}  // namespace keepout
