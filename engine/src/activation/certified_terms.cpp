// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "certified_terms.h"

#include <cmath>
#include <optional>

#include "tolerance_ladder.h"

namespace keepout {
namespace {

// Of a proof, in units of the tolerance.
constexpr double proof_slack = 1.0 / 64.0;

// A plane that an accepted motion is farther from, as a share of it, has not shaped it.
constexpr double idle_slack = 1e-6;

/// A plane's normal on its way from an old one to a wanted one, n = old + theta (wanted - old). The
/// normals that allow a motion are a convex cone, so those that do are an interval from theta 0.
class Turn {
 public:
  Turn(const HalfSpace& plane, const Vec3& wanted, const Triangle& corners, double target,
       const Vec3& kept, double slack) noexcept
      : old_(plane.normal),
        change_(wanted - plane.normal),
        corners_(corners),
        target_(target),
        kept_(kept),
        slack_(slack),
        least_at_0_(std::min(-plane.offset, 0.0) - slack),
        least_at_end_(std::min(plane.normal.dot(kept) - plane.offset, 0.0) - slack) {}

  /// The plane at theta, if it goes on allowing what is to be allowed.
  std::optional<HalfSpace> at(double theta, TriangleId source) noexcept {
    blend_ = old_ + theta * change_;
    length_ = blend_.norm();
    if (!(length_ > 1e-3)) return std::nullopt;  // all but opposite: no direction in between
    const Vec3 n = blend_ / length_;
    const double offset = support(corners_, n) + target_;
    at_0_ = -offset - least_at_0_;
    at_end_ = n.dot(kept_) - offset - least_at_end_;
    if (at_0_ < 0.0 || at_end_ < 0.0) return std::nullopt;
    return HalfSpace{n, offset, source};
  }

  /// Newton's next theta after one that failed. What a blend allows, times its length, is concave
  /// in theta: so this comes from above, and never passes the last theta that holds. It heads for
  /// half of the slack, so as to arrive.
  double next(double theta) const noexcept {
    const bool ends = at_end_ < at_0_;
    const double missing = length_ * ((ends ? at_end_ : at_0_) - 0.5 * slack_);
    const Vec3* deepest = &corners_[0];
    for (const Vec3& corner : corners_) {
      if (blend_.dot(corner) > blend_.dot(*deepest)) deepest = &corner;
    }
    const double least = ends ? least_at_end_ : least_at_0_;
    double slope = -change_.dot(*deepest) - (target_ + least) * change_.dot(blend_) / length_;
    if (ends) slope += change_.dot(kept_);
    if (!(slope < 0.0)) return 0.0;
    return theta - missing / slope;
  }

 private:
  Vec3 old_;
  Vec3 change_;
  const Triangle& corners_;
  double target_;
  Vec3 kept_;
  double slack_;
  double least_at_0_;
  double least_at_end_;
  Vec3 blend_;         // of the last theta
  double length_ = 0;  // |blend|
  double at_0_ = 0;    // what it leaves, less what it has to
  double at_end_ = 0;
};

}  // namespace

CertifiedTerms CertifiedTerms::keeping(double margin, double tolerance) noexcept {
  return {tolerance, margin, margin - demand_below * tolerance, margin - floor_below * tolerance};
}

CertifiedTerms CertifiedTerms::leading_off(double nearest, double lift, double tolerance) noexcept {
  return {tolerance, nearest + lift, nearest, nearest};
}

bool CertifiedTerms::is_covered(const Triangle& corners, const Vec3& trial,
                                std::span<const HalfSpace> planes) const noexcept {
  return std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return separates(plane.normal, corners, trial, most_demand, proof_slack * tolerance);
  });
}

bool CertifiedTerms::keeps_clear(const Facet& facet, const Vec3& trial,
                                 bool answered) const noexcept {
  const double level = answered ? floor(facet) : demand(facet);
  return keepout::keeps_clear(facet, trial, level, proof_slack * tolerance);
}

Contact CertifiedTerms::contact(const Facet& facet, const Vec3& trial,
                                double latest) const noexcept {
  return first_contact(facet, trial, target, contact_slack * tolerance, latest);
}

bool CertifiedTerms::is_beyond_doubt(const Contact& contact, const Facet& facet,
                                     const Vec3& trial) const noexcept {
  if (!contact.is_reached) return false;
  const double along = contact.touched.dot(trial) / trial.squaredNorm();
  const Vec3 nearest = std::clamp(along, 0.0, 1.0) * trial - contact.touched;
  constexpr double clearly = 1.0 - 1e-5;  // beside the root of a rounding
  return nearest.norm() < clearly * floor(facet);
}

HalfSpace CertifiedTerms::answer(const Facet& facet, const Surroundings& around, const Vec3& trial,
                                 const HalfSpace& contact) const noexcept {
  if (around.kept.isZero(0.0)) return contact;
  const std::optional<Vec3> proof =
      proof_of_clearance(facet, around.kept, floor(facet), proof_slack * tolerance);
  if (!proof) return contact;
  const HalfSpace plane{*proof, facet.support(*proof) + target, facet.source()};
  return turned(plane, facet, around.kept, trial);
}

HalfSpace CertifiedTerms::turned(const HalfSpace& plane, const Facet& facet, const Vec3& kept,
                                 const Vec3& towards) const noexcept {
  const Vec3 wanted = facet.nearest_to(towards).normal;
  Turn turn(plane, wanted, facet.corners(), target, kept, proof_slack * tolerance);
  constexpr int most_evaluations = 16;  // five were seen
  double theta = 1.0;
  for (int i = 0; i < most_evaluations; ++i) {
    if (const std::optional<HalfSpace> found = turn.at(theta, plane.source)) return *found;
    theta = std::min(turn.next(theta), theta);
    if (!(theta > 1e-6)) break;  // not worth it
  }
  return plane;
}

void CertifiedTerms::ways_around(const Facet& facet, HalfSpaceBuffer& ways) const noexcept {
  const auto add = [&](const Vec3& n) {
    const double offset = facet.support(n) + target;
    if (!n.isZero(0.0) && offset <= proof_slack * tolerance) {
      ways.push({n, offset, facet.source()});
    }
  };
  add(facet.face_normal());
  for (int edge = 0; edge < 3; ++edge) add(facet.normal_around(edge, target));
}

bool is_idle(const HalfSpace& plane, const Surroundings& around) noexcept {
  return plane.normal.dot(around.kept) - plane.offset > idle_slack * around.aim.norm();
}

double certified_tolerance(const Surroundings& around, double longest_edge) noexcept {
  return 2e-10 * (longest_edge + around.radius + around.margin) + 4e-16 * around.tip.lpNorm<1>();
}

Ball certified_region(const Surroundings& around, double tolerance) noexcept {
  const double beyond = around.margin + region_beyond * tolerance;
  if (around.searched == Reach::sphere) return {around.tip, around.longest + beyond};
  // Projections of the aim on a convex set that holds 0 lie in the ball over it (Thales).
  return {around.tip + 0.5 * around.aim, 0.5 * around.aim.norm() + beyond};
}

}  // namespace keepout
