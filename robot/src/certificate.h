// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/index/budget.h"
#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

/// The proof that one body maintains its clearance from triangles on a motion that is not straight
/// (docs/joint-space-step.md). On a sub-interval of the motion, a point's height over a plane is at
/// least that of a parabola through both ends. The bound of the point's second derivative gives the
/// curvature of the parabola. A plane proves the body clear on a sub-interval under two conditions.
/// The triangle, grown by the due clearance, is behind the plane. The parabolas of all points of
/// the body are in front of it. A sub-interval is also proved if the distance at its start exceeds
/// the largest displacement. Other sub-intervals are halved, down to the grid of PointMotion.
/// Planes that prove a sub-interval or its parts for one triangle are tried for the next triangles,
/// which are often its neighbors.
class Certificate {
 public:
  /// The obstacle to a proof. By default there is no obstacle. Knot 0 without a triangle: the
  /// budget ended, or the triangles nearby are not known.
  struct Obstacle {
    int knot = PointMotion::last_knot;  // the motion is proved up to here
    /// The triangle that limits the proof; or null. Valid until the pair's triangles are gathered
    /// again.
    NearTriangle* triangle = nullptr;
  };

  /// Prepares the proof for the motion of a body beside a mesh, and the triangles near it.
  /// `demand`: the clearance to certify, from the body's surface [length]. All arguments must
  /// outlive the certificate.
  Certificate(const Instrument& instrument, std::size_t body, RelativeMotion& motion, NearSet& near,
              double demand, double tolerance, Budget& budget) noexcept;

  /// Adds a normal, that of a row on the body, whose planes judge() tries before others.
  void try_first(const Vec3& normal) noexcept;

  /// Returns the first obstacle to the motion; if several are at the same knot, the triangle with
  /// the lowest number. `displacement`: RelativeMotion::largest_displacement [length].
  Obstacle judge(std::span<NearTriangle> triangles, double displacement) noexcept;
  /// Returns true if a judged triangle has a deficit: its clearance is below the demand, so the
  /// motion must end farther from it than it starts (docs/joint-space-step.md, "Due clearance").
  bool owes() const noexcept { return owes_; }

 private:
  /// A normal, and the least height of the body along it on the whole motion.
  struct Plane {
    Vec3 normal;
    double least;
  };
  static constexpr std::size_t most_planes = 12;

  /// A knot, and the gap between the body and the current triangle there. Computed when it is first
  /// needed.
  struct Place {
    int knot;
    bool is_known = false;
    Gap gap = {};
  };

  const Gap& gap_at(Place& place, const Triangle& corners) noexcept;
  double least_height(const Vec3& normal, int lo, int hi) noexcept;
  bool separates(const Vec3& normal, const NearTriangle& triangle, int lo, int hi) noexcept;
  bool is_covered(const NearTriangle& triangle) const noexcept;
  bool is_covered(const NearTriangle& triangle, int lo, int hi) const noexcept;
  bool is_covered_in_parts(const NearTriangle& triangle, int lo, int hi) const noexcept;
  bool is_proved_from(const NearTriangle& triangle, Place& lo, const Place& hi) noexcept;
  bool is_proved_to(const NearTriangle& triangle, const Place& lo, Place& hi) noexcept;
  int proved_until(const NearTriangle& triangle, Place& lo, Place& hi) noexcept;

  std::size_t body_;
  std::span<const std::uint8_t> points_;
  double radius_;
  RelativeMotion& motion_;
  NearSet& near_;
  double demand_;
  double tolerance_;
  Budget& budget_;
  bool owes_ = false;
  /// The due clearance from the current triangle, plus 2 tolerances. Proofs by a plane demand 2
  /// tolerances less, for rounding. [length]
  double due_plus_rounding_ = 0.0;
  int latest_ = PointMotion::last_knot;  // a proof beyond this knot makes no difference
  std::array<Plane, most_planes> planes_;
  std::size_t plane_count_ = 0;
  // The plane that last proved each sub-interval, by its number: the whole motion is 1, the halves
  // of sub-interval i are 2 i and 2 i + 1.
  std::array<Plane, 2 * PointMotion::last_knot> plane_of_part_;
  std::array<bool, 2 * PointMotion::last_knot> has_plane_{};
};

}  // namespace keepout
