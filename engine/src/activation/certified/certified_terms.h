// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/first_contact.h"
#include "keepout/activation/prepared_triangle.h"
#include "keepout/activation/tolerances.h"
#include "straight_clearance.h"

namespace keepout {

// A plane that rotates by less than this gains a motion too little. [fraction of the motion]
inline constexpr double least_turn = 1e-6;

/// The terms of a certified cycle: the levels, which are the distances that a trial must keep from
/// each triangle, and the tests and planes that follow from them. Rule 2 of docs/certified-step.md
/// defines the levels. Here m is the required clearance, and d the distance of the nearest prepared
/// triangle. A prepared triangle has the distance d_T, of which its normal proves p_T. tau is the
/// tolerance, and s = 1/64 tau the slack of a proof:
///
///                     keeping               recovering
///      plane_level    m                     d + lift
///      demand         min(m - tau, d_T)     min(d + tau / 2, p_T + slack_compensation)
///      floor          min(m - 2 tau, d_T)   min(d, p_T) + slack_compensation
///
/// Every decision depends only on one triangle, the trial and the present planes. So the answers
/// are bitwise identical in any order of the triangles.
struct CertifiedTerms {
  double tolerance;    // tau: see CertifiedRule::tolerance [length]
  double plane_level;  // level of every plane [length]
  double most_demand;  // the largest demand, on triangles without a plane of their own [length]
  double most_floor;   // the largest floor, of triangles with a plane of their own [length]
  double lift = 0.0;   // the lift of a recovering cycle; 0 if keeping, or once dropped [length]
  bool is_recovering = false;
  /// s - 1e-5 tau in a recovering cycle, else 0. It raises the levels, so that the slack of the
  /// proofs is not lost again in each cycle. [length]
  double slack_compensation = 0.0;

  /// Returns the levels of a tip that keeps the required clearance.
  static CertifiedTerms keeping(double clearance, double tolerance) noexcept;

  /// Returns the levels of a tip that is too close. The mesh may not come closer than its nearest
  /// triangle is, and triangles as close retreat by `lift`. Triangles a little farther off may not
  /// come as close either. So clearance that rounding loses at one triangle is regained before it
  /// is lost at another.
  static CertifiedTerms recovering(double nearest, double lift, double tolerance) noexcept;

  double demand(const PreparedTriangle& prepared) const noexcept {
    return std::min(most_demand, present(prepared));
  }
  double floor(const PreparedTriangle& prepared) const noexcept {
    return std::min(most_floor, present(prepared));
  }

  /// Returns the present distance of a prepared triangle, the most that is demanded of a trial.
  /// When keeping, it is the computed distance. When recovering, it is the proven distance plus the
  /// compensation. (The proven distance is minus the support of the normal: Lemma 2 at the tip, as
  /// corners are relative to it.) [length]
  double present(const PreparedTriangle& prepared) const noexcept {
    return is_recovering ? slack_compensation - prepared.at_tip().support : prepared.distance();
  }

  /// Relaxes planes that contradict each other: divides the lift by eight, and finally drops it.
  /// When keeping there is no lift, and offsets above 0, which are at most some tolerances, become
  /// 0. Returns true if any plane changed.
  bool relax(HalfSpaceBuffer& planes) noexcept;

  /// Returns true if a present plane proves that the trial stays clear of a triangle: rule 5 (a),
  /// at most_demand, because the triangle's own distance is not known yet. `corners`: relative to
  /// the tip.
  bool is_covered(const Triangle& corners, const Vec3& trial,
                  std::span<const HalfSpace> planes) const noexcept;

  /// Returns true if the normal at the tip proves the demand: rule 5 (c), the fastest test.
  bool is_clear_at_once(const PreparedTriangle& prepared, const Vec3& trial) const noexcept {
    return line_of(prepared.at_tip(), trial, demand(prepared))
        .proves_clear(proof_slack * tolerance);
  }

  /// Returns true if some normal proves the demand, or the floor if the prepared triangle has a
  /// plane of its own: rule 5 (c).
  bool stays_clear(const PreparedTriangle& prepared, const Vec3& trial,
                   bool has_own_plane) const noexcept;

  /// Returns the first contact of a trial with the prepared triangle, at plane_level; see
  /// first_contact.
  Contact contact(const PreparedTriangle& prepared, const Vec3& trial,
                  double latest) const noexcept;

  /// Returns true if stays_clear() is surely false. This quick test is true for most contacts: the
  /// trial comes clearly closer than the floor to the touched point of the prepared triangle.
  bool is_surely_too_close(const Contact& contact, const PreparedTriangle& prepared,
                           const Vec3& trial) const noexcept;

  /// Returns the plane for a prepared triangle in the way. Without an accepted motion, it is the
  /// plane of the contact, which allows standing still. Otherwise it is the plane that proves the
  /// accepted motion clear, rotated towards the trial's end.
  HalfSpace plane_for(const PreparedTriangle& prepared, const RuleInput& input, const Vec3& trial,
                      const HalfSpace& contact) const noexcept;

  /// Rotates a prepared triangle's plane towards the normal at the end of a motion, as far as it
  /// still allows the kept motion and standing still (Lemma 7).
  HalfSpace turned(const HalfSpace& plane, const PreparedTriangle& prepared, const Vec3& kept,
                   const Vec3& towards) const noexcept;

  /// See ActivationRule::add_alternatives.
  void add_alternatives(const PreparedTriangle& prepared, HalfSpaceBuffer& planes) const noexcept;
};

/// Returns true if the accepted motion is so far from a plane that the plane has not shaped it.
bool is_idle(const HalfSpace& plane, const RuleInput& input) noexcept;

/// Returns the distance that an opening reports: that of the nearest prepared triangle, or nothing
/// if it is too far away. It must be so near that every kind of index shows all triangles as near.
/// Farther off, one kind may show triangles that another does not. The limit is the clearance and a
/// little more. One bound is half of the excess of the searched region (region_beyond). The other
/// is half of what a filter in single precision adds to the level, about 1e-6 of it (float_levels:
/// a slack of 2e-6 less the rounding of proof_lanes-inl.h).
std::optional<double> known_distance(const PreparedTriangle* nearest, double clearance,
                                     double tolerance) noexcept;

}  // namespace keepout
