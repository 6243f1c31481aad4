// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>

#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/half_space.h"
#include "keepout/geometry/triangle.h"
#include "keepout/geometry/vec3.h"

namespace keepout {

/// The corners of a triangle in lexicographic order, relative to the tip. Ordered before the tip is
/// taken off, whose rounding could make different coordinates equal.
Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept;

/// max n . p over the points p of a triangle. [length]
inline double support(const Triangle& corners, const Vec3& n) noexcept {
  return std::max({n.dot(corners[0]), n.dot(corners[1]), n.dot(corners[2])});
}

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

  /// Of corners that are relative to the tip and in lexicographic order already.
  Facet(const Triangle& ordered, TriangleId source) noexcept;

  TriangleId source() const noexcept { return source_; }
  const Triangle& corners() const noexcept { return corners_; }

  /// Its distance from the tip. [length]
  double distance() const noexcept { return distance_; }

  /// Unit vector from the closest point to `point`; of all that it could be within rounding, the
  /// one that proves the largest distance. Zero where the point is on the facet. `distance` is set
  /// to the distance of the point. [length]
  Vec3 normal_at(const Vec3& point, double& distance) const noexcept {
    Feature feature;
    return normal_at(point, distance, feature);
  }

  /// The same, and where on the facet the closest point lies.
  Vec3 normal_at(const Vec3& point, double& distance, Feature& feature) const noexcept;

  /// normal_at the tip.
  const Vec3& normal() const noexcept { return normal_; }
  Feature feature() const noexcept { return feature_; }

  /// The direction of an edge (0, 1, 2), of its length. [length]
  Vec3 edge(int number) const noexcept { return corners_[(number + 1) % 3] - corners_[number]; }

  /// max n . p over the points p of the facet. [length]
  double support(const Vec3& n) const noexcept { return keepout::support(corners_, n); }

  /// The facet's own unit normal, on the side of the tip; zero without an area.
  Vec3 face_normal() const noexcept;

  /// The unit normal of the plane through the tip that has the facet on its far side, `level` away,
  /// and one of its edges (0, 1, 2) just so: the way around that edge. Zero when the edge's line
  /// comes closer than that, or when the facet sticks out on the other side.
  Vec3 normal_around(int edge, double level) const noexcept;

  /// Whether the facet comes before another by its corners; a total order but for duplicates.
  bool before(const Facet& other) const noexcept;

 private:
  Vec3 plane_normal() const noexcept;
  Vec3 facing(const ClosestPoint& closest) const noexcept;
  Vec3 across(const Vec3& n, int edge) const noexcept;

  Triangle corners_;                 // relative to the tip [length]
  Vec3 normal_;                      // at the tip
  double distance_ = 0;              // of the tip [length]
  Feature feature_ = Feature::face;  // nearest to the tip
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

/// Whether a plane with normal n is such a proof: it has the triangle, relative to the tip and
/// grown by `level`, on one side and both ends of the motion on the other.
inline bool separates(const Vec3& n, const Triangle& corners, const Vec3& z, double level,
                      double slack) noexcept {
  const double at_0 = -support(corners, n) - level;
  return at_0 >= -slack && at_0 + n.dot(z) >= -slack;
}

/// Where a motion first comes within `level` of a facet.
struct Contact {
  /// When: a share t of the motion, below 0 when the facet is closer already. Sharper than the
  /// normal, so that of facets that are all but equally early the earliest is told.
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
