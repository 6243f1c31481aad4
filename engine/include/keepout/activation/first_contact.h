// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/facet.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The place and time at which a motion first comes within `level` of a facet.
struct Contact {
  /// Fraction t of the motion, negative if the facet is closer already. Sharper than the normal, so
  /// that the earliest of several almost simultaneous contacts is found.
  double time;
  HalfSpace plane;  // that the facet, grown by `level`, is behind; allows 0 unless already closer
  bool is_reached = false;      // or given up, or never
  Vec3 touched = Vec3::Zero();  // of the facet, to within the root of a rounding; if it is reached
};

/// The first contact of a motion that is not clear, by Newton's method from the left on the
/// convex distance, which never goes past it; where the nearest corner or side stays the nearest
/// one, its own contact is the facet's, and found in one leap. Gives up, with a time after
/// `latest`, as soon as the contact is known to be later than that. `slack`: how close is close
/// enough. [length]
Contact first_contact(const Facet& facet, const Vec3& z, double level, double slack,
                      double latest) noexcept;

}  // namespace keepout
