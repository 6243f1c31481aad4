// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// Returns max n . p over the points p of a triangle. [length]
inline double support(const Triangle& corners, const Vec3& n) noexcept {
  return std::max({n.dot(corners[0]), n.dot(corners[1]), n.dot(corners[2])});
}

/// A triangle prepared for proofs: relative to the tip, with its corners in lexicographic order. So
/// no result depends on its winding, its number, its first corner or the distance of the origin.
///
/// Proofs rest on Lemma 2 of docs/certified-step.md. The distance from the point t z of a motion z
/// to a triangle is convex in t. Each unit vector n bounds it from below by n . (t z) - support(n).
/// The bound is exact at the t where n points from the closest point of the triangle to t z.
class PreparedTriangle {
 public:
  /// The prepared triangle's closest point to a point, as a proof of the distance.
  struct Nearest {
    Vec3 normal;      // unit vector from the closest point; zero for a point on the triangle
    double distance;  // from the closest point to the point [length]
    double support;   // of the prepared triangle along the normal [length]
    Feature feature;  // on which the closest point lies
  };

  PreparedTriangle() = default;
  /// Prepares a triangle given in the frame of the mesh, relative to a tip.
  PreparedTriangle(const Triangle& triangle, const Vec3& tip, TriangleId number) noexcept;

  /// Prepares a triangle whose corners are relative to the tip and in lexicographic order already.
  PreparedTriangle(const Triangle& ordered, TriangleId number) noexcept;

  /// Returns the triangle's number; no_triangle until one is given.
  TriangleId triangle() const noexcept { return triangle_; }
  /// Returns the corners, in lexicographic order, relative to the tip. [length]
  const Triangle& corners() const noexcept { return corners_; }

  /// Returns the closest point to a point: the one that closest_point() returns, but with a proof
  /// of the distance. (The offset of closest_point() might not prove the distance: A9 of
  /// docs/certified-step.md.) The returned normal proves the largest distance of all normals that
  /// agree within rounding.
  Nearest nearest_to(const Vec3& point) const noexcept;

  /// Like nearest_to(point), but faster if the closest point lies on the `likely` feature.
  Nearest nearest_to(const Vec3& point, Feature likely) const noexcept;

  /// Returns nearest_to(point) for the tip.
  const Nearest& at_tip() const noexcept { return at_tip_; }
  /// Returns the distance of the tip. [length]
  double distance() const noexcept { return at_tip_.distance; }
  /// Returns the unit vector towards the tip; zero if the tip is on the prepared triangle.
  const Vec3& towards_tip() const noexcept { return at_tip_.normal; }

  /// Returns an edge (0, 1, 2) as a vector from its first corner. [length]
  Vec3 edge(int number) const noexcept { return corners_[(number + 1) % 3] - corners_[number]; }

  /// Returns max n . p over the points p of the prepared triangle. [length]
  double support(const Vec3& n) const noexcept { return keepout::support(corners_, n); }

  /// Returns true unless the prepared triangle is a needle. A needle is treated as its three edges.
  bool has_face() const noexcept { return determinant_ > 0.0; }

  /// Returns the point of the face's plane that is closest to a point. It may be outside the face.
  /// Precondition: has_face().
  Nearest on_face_plane(const Vec3& point) const noexcept;

  /// Returns true if the projection of a point onto the plane of the face is inside the face; false
  /// for a needle.
  bool has_above(const Vec3& point) const noexcept;

  /// Returns the prepared triangle's own unit normal, on the side to which `direction` does not
  /// point; zero if the triangle has no area.
  Vec3 normal_against(const Vec3& direction) const noexcept;

  /// Returns the unit normal of the plane through the tip that allows motion around edge 0, 1 or 2.
  /// The prepared triangle is on the far side of the plane. The triangle is at least `level` from
  /// the plane, and the edge exactly `level`. Returns zero if the line of the edge is closer than
  /// `level`, or if no plane has the whole triangle on its far side.
  Vec3 normal_around(int edge, double level) const noexcept;

  /// Returns true if the prepared triangle precedes another in lexicographic order of their
  /// corners. This is a total order, except for duplicates.
  bool before(const PreparedTriangle& other) const noexcept;

 private:
  /// A point's coordinates along the edges from corner 0 to corners 1 and 2.
  struct Shares {
    double along_01;  // (corner 1 - corner 0) . (point - corner 0)
    double along_02;
    double of_1;  // barycentric coordinates of the corners, times the determinant
    double of_2;

    bool are_inside(double determinant) const noexcept {
      return of_1 > 0.0 && of_2 > 0.0 && of_1 + of_2 < determinant;
    }
  };

  Shares shares(const Vec3& point) const noexcept;
  bool is_nearest(const Vec3& point, const Vec3& off, double distance, Feature feature,
                  Nearest& nearest) const noexcept;
  bool edge_is_nearest(const Vec3& point, int edge, Nearest& nearest) const noexcept;
  bool corner_is_nearest(const Vec3& point, int corner, Nearest& nearest) const noexcept;
  Nearest nearest_with_care(const Vec3& point) const noexcept;

  Vec3 across(const Vec3& n, int edge) const noexcept;

  Triangle corners_;  // relative to the tip [length]
  // Squared lengths of the edges at corner 0, and their product. [length^2]
  double length2_01_ = 0;
  double length2_02_ = 0;
  double product_ = 0;
  double determinant_ = 0;  // of their Gram matrix; 0 for a needle [length^4]
  Vec3 face_normal_;        // unit, on an arbitrary side; zero for a needle
  Nearest at_tip_;
  TriangleId triangle_ = no_triangle;
};

}  // namespace keepout
