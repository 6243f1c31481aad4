// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/half_space.h"
#include "keepout/geometry/triangle.h"
#include "keepout/geometry/vec3.h"

namespace keepout {

/// A triangle as a motion sees it: relative to the tip, its corners in lexicographic order, so that
/// nothing depends on how it is wound, rotated or numbered, nor on how far off the origin lies.
///
/// Everything below rests on one fact: the distance of the point t z to a triangle is convex in t,
/// and each unit vector n bounds it from below by n . (t z) - support(n), with equality at the t
/// where n points from the triangle's closest point to t z.
class Facet {
 public:
  Facet() = default;
  Facet(const Triangle& triangle, const Vec3& tip, TriangleId source) noexcept;

  TriangleId source() const noexcept { return source_; }

  /// Its distance from the tip. [length]
  double distance() const noexcept { return distance_; }

  /// Unit vector from the closest point to `point`; of all that it could be within rounding, the
  /// one that proves the largest distance. Zero where the point is on the facet. `distance` is set
  /// to the distance of the point. [length]
  Vec3 normal_at(const Vec3& point, double& distance) const noexcept;

  /// normal_at the tip.
  const Vec3& normal() const noexcept { return normal_; }

  /// max n . p over the points p of the facet. [length]
  double support(const Vec3& n) const noexcept;

  /// The facet's own unit normal, on the side of the tip; zero without an area.
  Vec3 face_normal() const noexcept;

  /// The unit normal of the plane through the tip that has the facet on its far side, `level` away,
  /// and one of its edges (0, 1, 2) just so: the way around that edge. Zero when the edge's line
  /// comes closer than that, or when the facet sticks out on the other side.
  Vec3 normal_around(int edge, double level) const noexcept;

  /// Whether the facet comes before another by its corners; a total order but for duplicates.
  bool before(const Facet& other) const noexcept;

 private:
  Vec3 facing(const ClosestPoint& closest) const noexcept;
  Vec3 across(const Vec3& n, int edge) const noexcept;

  Triangle corners_;     // relative to the tip [length]
  Vec3 normal_;          // at the tip
  double distance_ = 0;  // of the tip [length]
  TriangleId source_ = no_triangle;
};

/// The normal of a plane that proves that the whole motion from 0 to z keeps `level` from the
/// facet: dist(t z, T) >= level - slack for all t in [0, 1]. Nothing when the motion comes closer,
/// or when rounding hides the answer. Precondition: level <= facet.distance(), and far above the
/// rounding of lengths. [length]
std::optional<Vec3> proof_of_clearance(const Facet& facet, const Vec3& z, double level,
                                       double slack) noexcept;

inline bool keeps_clear(const Facet& facet, const Vec3& z, double level, double slack) noexcept {
  return proof_of_clearance(facet, z, level, slack).has_value();
}

/// Whether a plane with normal n is such a proof: it has the facet, grown by `level`, on one side
/// and both ends of the motion on the other.
bool separates(const Vec3& n, const Facet& facet, const Vec3& z, double level,
               double slack) noexcept;

/// Where a motion first comes within `level` of a facet.
struct Contact {
  /// When: a share t of the motion, below 0 when the facet is closer already. Sharper than the
  /// normal, so that of facets that are all but equally early the earliest is told.
  double time;
  HalfSpace plane;  // that the facet, grown by `level`, is behind; allows 0 unless already closer
};

/// The first contact of a motion that is not clear, by Newton's method from the left on the
/// convex distance, which never goes past it. Gives up, with a time after `latest`, as soon as the
/// contact is known to be later than that. `slack`: how close is close enough. [length]
Contact first_contact(const Facet& facet, const Vec3& z, double level, double slack,
                      double latest) noexcept;

}  // namespace keepout
