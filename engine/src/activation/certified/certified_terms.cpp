// SPDX-License-Identifier: BSD-3-Clause
#include "certified_terms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"

namespace keepout {
namespace {

// A plane that is farther from an accepted motion, as a fraction of the target, is idle.
constexpr double idle_slack = 1e-6;

/// A rotation of a plane: n = old + theta (wanted - old), normalized. The normals that allow a
/// motion are a convex cone, so the allowed theta are an interval from 0 (Lemma 7). Its levels l_0
/// and l_1 are the `least` of both ends.
class Turn {
 public:
  Turn(const HalfSpace& plane, const Vec3& change, const Triangle& corners, double plane_level,
       const Vec3& kept, double slack) noexcept
      : old_(plane.normal), change_(change), slack_(slack) {
    const double along_kept = old_.dot(kept);
    ends_[0] = {0.0, 0.0, plane_level + std::min(-plane.offset, 0.0) - slack};
    ends_[1] = {along_kept, change_.dot(kept),
                plane_level + std::min(along_kept - plane.offset, 0.0) - slack};
    for (std::size_t c = 0; c < 3; ++c) {
      depth_[c] = old_.dot(corners[c]);
      deepens_[c] = change_.dot(corners[c]);
    }
  }

  /// Returns true if the plane at theta allows the kept motion and standing still.
  bool is_allowed_at(double theta) noexcept {
    blend_ = old_ + theta * change_;
    length_ = blend_.norm();
    if (!(length_ > 1e-3)) return false;  // almost opposite: no direction in between
    deepest_ = 0;
    double most = depth_[0] + theta * deepens_[0];
    for (std::size_t c = 1; c < 3; ++c) {
      const double depth = depth_[c] + theta * deepens_[c];
      deepest_ = depth > most ? c : deepest_;
      most = std::max(depth, most);
    }
    const auto spare = [&](const End& end) {
      return end.along_old + theta * end.along_change - most - end.least * length_;
    };
    const double at_0 = spare(ends_[0]);
    const double at_end = spare(ends_[1]);
    tight_ = at_end < at_0 ? 1 : 0;
    spare_ = std::min(at_end, at_0);
    return !(spare_ < 0.0);
  }

  /// Returns the unit normal at the last theta.
  Vec3 normal() const noexcept { return blend_ / length_; }

  /// Returns Newton's next theta after one that is not allowed. The distance that a blend leaves is
  /// concave in theta. So the iteration comes from above, and never passes the last theta that is
  /// allowed. It aims at half of the slack, so that it ends.
  double next(double theta) const noexcept {
    const End& end = ends_[tight_];
    const double missing = spare_ - 0.5 * slack_ * length_;
    const double slope =
        end.along_change - deepens_[deepest_] - end.least * change_.dot(blend_) / length_;
    if (!(slope < 0.0)) return 0.0;
    return theta - missing / slope;
  }

 private:
  /// An end of the kept motion, and the least distance that a plane must leave between it and the
  /// corners.
  struct End {
    double along_old;
    double along_change;
    double least;
  };

  Vec3 old_;
  Vec3 change_;
  double slack_;
  std::array<End, 2> ends_;
  std::array<double, 3> depth_;    // of the corners along the old normal
  std::array<double, 3> deepens_;  // of the corners along the change
  // At the last theta.
  Vec3 blend_;
  double length_ = 0;  // |blend|
  double spare_ = 0;   // distance beyond `least`, times length_
  std::size_t tight_ = 0;
  std::size_t deepest_ = 0;
};

}  // namespace

CertifiedTerms CertifiedTerms::keeping(double clearance, double tolerance) noexcept {
  return {.tolerance = tolerance,
          .plane_level = clearance,
          .most_demand = clearance - demand_below * tolerance,
          .most_floor = clearance - floor_below * tolerance};
}

CertifiedTerms CertifiedTerms::recovering(double nearest, double lift, double tolerance) noexcept {
  const double slack_compensation = (proof_slack - 1e-5) * tolerance;
  return {.tolerance = tolerance,
          .plane_level = nearest + lift,
          .most_demand = nearest + 0.5 * tolerance,
          .most_floor = nearest + slack_compensation,
          .lift = lift,
          .is_recovering = true,
          .slack_compensation = slack_compensation};
}

bool CertifiedTerms::relax(HalfSpaceBuffer& planes) noexcept {
  const double less = lift > 8.0 * tolerance ? 0.125 * lift : 0.0;
  if (less == 0.0) {
    if (lift > 0.0) most_demand = most_floor;  // once, when the retreat is dropped
    lift = 0.0;
    return let_stand_still(planes);
  }
  bool changed = false;
  for (HalfSpace& plane : planes) {
    if (plane.source == no_triangle) continue;  // the bound of the motion sphere
    changed = changed || plane.offset > 0.0;
    plane.offset -= lift - less;
  }
  plane_level -= lift - less;
  lift = less;
  return changed;
}

bool CertifiedTerms::is_covered(const Triangle& corners, const Vec3& trial,
                                std::span<const HalfSpace> planes) const noexcept {
  return std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return separates(plane.normal, corners, trial, most_demand, proof_slack * tolerance);
  });
}

bool CertifiedTerms::stays_clear(const PreparedTriangle& prepared, const Vec3& trial,
                                 bool has_own_plane) const noexcept {
  const double level = has_own_plane ? floor(prepared) : demand(prepared);
  return proof_of_clearance(prepared, trial, level, proof_slack * tolerance).has_value();
}

Contact CertifiedTerms::contact(const PreparedTriangle& prepared, const Vec3& trial,
                                double latest) const noexcept {
  return first_contact(prepared, trial, plane_level, contact_slack * tolerance, latest);
}

bool CertifiedTerms::is_surely_too_close(const Contact& contact, const PreparedTriangle& prepared,
                                         const Vec3& trial) const noexcept {
  if (!contact.is_reached) return false;
  const double along = contact.touched.dot(trial) / trial.squaredNorm();
  const Vec3 nearest = std::clamp(along, 0.0, 1.0) * trial - contact.touched;
  // Clearly closer: by more than the rounding of `touched` and the slack of stays_clear, however
  // small the floor is.
  constexpr double clearly = 1.0 - 1e-5;
  return nearest.norm() < clearly * floor(prepared) - 2.0 * proof_slack * tolerance;
}

HalfSpace CertifiedTerms::plane_for(const PreparedTriangle& prepared, const RuleInput& input,
                                    const Vec3& trial, const HalfSpace& contact) const noexcept {
  if (input.accepted.isZero(0.0)) return contact;
  const std::optional<Vec3> proof =
      proof_of_clearance(prepared, input.accepted, floor(prepared), proof_slack * tolerance);
  if (!proof) return contact;
  const HalfSpace plane{*proof, prepared.support(*proof) + plane_level, prepared.triangle()};
  return turned(plane, prepared, input.accepted, trial);
}

HalfSpace CertifiedTerms::turned(const HalfSpace& plane, const PreparedTriangle& prepared,
                                 const Vec3& kept, const Vec3& towards) const noexcept {
  const Vec3 change = prepared.nearest_to(towards).normal - plane.normal;
  if (!(change.squaredNorm() > least_turn * least_turn)) return plane;
  Turn turn(plane, change, prepared.corners(), plane_level, kept, proof_slack * tolerance);
  constexpr int most_evaluations = 16;  // the most seen is 5
  double theta = 1.0;
  for (int i = 0; i < most_evaluations; ++i) {
    if (turn.is_allowed_at(theta)) {
      const Vec3 n = turn.normal();
      return {n, prepared.support(n) + plane_level, plane.source};
    }
    theta = std::min(turn.next(theta), theta);
    if (!(theta > 1e-6)) break;  // too small a rotation to matter
  }
  return plane;
}

void CertifiedTerms::add_alternatives(const PreparedTriangle& prepared,
                                      HalfSpaceBuffer& planes) const noexcept {
  const auto add = [&](const Vec3& n) {
    const double offset = prepared.support(n) + plane_level;
    if (!n.isZero(0.0) && offset <= proof_slack * tolerance) {
      planes.push({n, offset, prepared.triangle()});
    }
  };
  add(prepared.normal_against(prepared.corners()[0]));  // of the face, towards the tip
  for (int edge = 0; edge < 3; ++edge) add(prepared.normal_around(edge, plane_level));
}

bool is_idle(const HalfSpace& plane, const RuleInput& input) noexcept {
  return plane.normal.dot(input.accepted) - plane.offset > idle_slack * input.target.norm();
}

std::optional<double> known_distance(const PreparedTriangle* nearest, double clearance,
                                     double tolerance) noexcept {
  const double beyond = std::min(0.5 * region_beyond * tolerance, 5e-7 * clearance);
  if (nearest == nullptr || nearest->distance() > clearance + beyond) return std::nullopt;
  return nearest->distance();
}

}  // namespace keepout
