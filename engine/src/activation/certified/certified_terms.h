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

// A plane that turns by less than this gains a motion too little, as a fraction of its length.
inline constexpr double least_turn = 1e-6;

/// The terms of a certified cycle: the levels, which are the distances that a trial must keep from
/// each triangle, and the tests and planes that follow from them. The levels are those of rule 2 of
/// docs/certified-step.md, with m the required clearance, d the distance of the nearest prepared
/// triangle, d_T that of a prepared triangle, p_T the distance that its normal proves, tau the
/// tolerance and s = 1/64 tau the slack of a proof:
///
///                        keeping               recovering
///     plane_level        m                     d + lift
///     demand(prepared triangle)      min(m - tau, d_T)     min(d + tau / 2, p_T +
///     slack_compensation) floor(prepared triangle)       min(m - 2 tau, d_T)   min(d, p_T) +
///     slack_compensation
///
/// Every decision is a function of one triangle, the trial and the present planes alone, so the
/// answers are bitwise identical in whatever order the triangles come.
struct CertifiedTerms {
  double tolerance;    // tau: see CertifiedRule::tolerance [length]
  double plane_level;  // distance at which planes are put [length]
  double most_demand;  // of triangles without a plane of their own [length]
  double most_floor;   // of triangles that have one [length]
  double lift = 0.0;   // the retreat of a tip that is too close; 0 if keeping, or once dropped
                       // [length]
  bool is_recovering = false;
  /// s - 1e-5 tau in a recovering cycle, else 0: levels are raised by this, so that the slack of
  /// the proofs is not lost again in each cycle. [length]
  double slack_compensation = 0.0;

  /// Returns the levels of a tip that keeps the required clearance.
  static CertifiedTerms keeping(double clearance, double tolerance) noexcept;

  /// Returns the levels of a tip that is too close. The mesh may not come closer than its nearest
  /// triangle, and triangles as close retreat by `lift`. Triangles a little farther off may not
  /// come as close either, so that clearance lost to rounding at one triangle is regained before it
  /// is lost at another.
  static CertifiedTerms recovering(double nearest, double lift, double tolerance) noexcept;

  double demand(const PreparedTriangle& prepared) const noexcept {
    return std::min(most_demand, present(prepared));
  }
  double floor(const PreparedTriangle& prepared) const noexcept {
    return std::min(most_floor, present(prepared));
  }

  /// Returns the present distance of a prepared triangle, the most that is demanded of a trial: as
  /// computed when keeping; when recovering, as proven, with the compensation. (Proven is minus the
  /// support of the normal: Lemma 2 at the tip, from where corners are counted.) [length]
  double present(const PreparedTriangle& prepared) const noexcept {
    return is_recovering ? slack_compensation - prepared.at_tip().support : prepared.distance();
  }

  /// Relaxes planes that contradict each other: divides the lift by eight, and in the end drops it.
  /// When keeping there is no lift, and offsets above 0, of some tolerances at most, become 0.
  /// Returns true if any plane changed.
  bool relax(HalfSpaceBuffer& planes) noexcept;

  /// Returns true if a present plane proves that the trial stays clear of a triangle, given by its
  /// corners relative to the tip: rule 5 (a), at most_demand, as the triangle's own distance is not
  /// known yet.
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

  /// Quick test: returns true if stays_clear() is surely false, as the trial comes clearly closer
  /// than the floor to the point of the prepared triangle that the contact touched. True for most
  /// contacts.
  bool is_surely_too_close(const Contact& contact, const PreparedTriangle& prepared,
                           const Vec3& trial) const noexcept;

  /// Returns the plane for a prepared triangle in the way: without an accepted motion, that of the
  /// contact, which allows standing still; else the plane that proves the accepted motion clear,
  /// turned towards the trial's end.
  HalfSpace plane_for(const PreparedTriangle& prepared, const RuleInput& input, const Vec3& trial,
                      const HalfSpace& contact) const noexcept;

  /// Turns a prepared triangle's plane towards the normal at the end of a motion, as far as it
  /// still allows the kept motion and standing still (Lemma 7).
  HalfSpace turned(const HalfSpace& plane, const PreparedTriangle& prepared, const Vec3& kept,
                   const Vec3& towards) const noexcept;

  /// See ActivationRule::add_alternatives.
  void add_alternatives(const PreparedTriangle& prepared, HalfSpaceBuffer& planes) const noexcept;
};

/// Returns true if the accepted motion is so far from a plane that the plane has not shaped it.
bool is_idle(const HalfSpace& plane, const RuleInput& input) noexcept;

/// Returns the distance that an opening reports: that of the nearest prepared triangle, if it is so
/// near that all kinds of index surely show all triangles as near; else nothing. That is the
/// clearance and a little more: half of what the searched region is larger by (region_beyond), and
/// half of what a filter in single precision adds to the level, about 1e-6 of it (float_levels: a
/// slack of 2e-6 less the rounding of proof_lanes-inl.h). Farther off, one kind may show triangles
/// that another does not.
std::optional<double> known_distance(const PreparedTriangle* nearest, double clearance,
                                     double tolerance) noexcept;

}  // namespace keepout
