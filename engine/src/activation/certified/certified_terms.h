// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/facet.h"
#include "keepout/activation/first_contact.h"
#include "keepout/activation/tolerances.h"
#include "straight_clearance.h"

namespace keepout {

// A plane that turns by less than this lets a motion gain less, as a fraction of its length, than
// is worthwhile.
inline constexpr double least_turn = 1e-6;

/// The levels of a certified cycle: the distances that a trial must keep from each triangle. They
/// are those of rule 2 of docs/certified-step.md, with m the required clearance, d the distance of
/// the nearest facet, d_T that of a facet, p_T the distance that its normal proves, tau the
/// tolerance and s = 1/64 tau the slack of a proof:
///
///                        keeping               recovering
///     plane_level        m                     d + lift
///     demand(facet)      min(m - tau, d_T)     min(d + tau / 2, p_T + slack_compensation)
///     floor(facet)       min(m - 2 tau, d_T)   min(d, p_T) + slack_compensation
///
/// Every decision is a function of one triangle, the trial and the present planes, and of nothing
/// else: so the answers are bitwise identical in whatever order the triangles come.
struct CertifiedTerms {
  double tolerance;    // tau: see CertifiedRule::tolerance [length]
  double plane_level;  // distance at which planes are put [length]
  double most_demand;  // of triangles without a plane of their own [length]
  double most_floor;   // of triangles that have one [length]
  double lift = 0.0;   // the retreat of a tip that is too close, at least a tolerance [length]
  /// s - 1e-5 tau in a recovering cycle: levels are raised by this, so that the slack of the proofs
  /// is not lost again in each cycle. [length]
  double slack_compensation = 0.0;

  /// Returns the levels of a tip that keeps the required clearance.
  static CertifiedTerms keeping(double clearance, double tolerance) noexcept;

  /// Returns the levels of a tip that is too close. The mesh may not come closer than its nearest
  /// triangle, and triangles as close retreat by `lift`. Triangles a little farther off may not
  /// come as close either, so that clearance lost to rounding at one triangle is regained before it
  /// is lost at another.
  static CertifiedTerms recovering(double nearest, double lift, double tolerance) noexcept;

  double demand(const Facet& facet) const noexcept { return std::min(most_demand, present(facet)); }
  double floor(const Facet& facet) const noexcept { return std::min(most_floor, present(facet)); }

  /// Returns the present distance of a facet, beyond which nothing is demanded: as computed when
  /// keeping, as proven when recovering.
  double present(const Facet& facet) const noexcept {
    return slack_compensation == 0.0 ? facet.distance()
                                     : slack_compensation - facet.at_tip().support;
  }

  /// Relaxes planes that contradict each other: divides the lift by eight, and in the end drops it.
  /// Returns true if any plane changed.
  bool relax(HalfSpaceBuffer& planes) noexcept;

  /// Returns true if a present plane proves that the trial stays clear of a triangle, given by its
  /// corners relative to the tip: rule 5 (a).
  bool is_covered(const Triangle& corners, const Vec3& trial,
                  std::span<const HalfSpace> planes) const noexcept;

  /// Returns true if the normal at the tip proves the demand: rule 5 (c), the fastest test.
  bool is_clear_at_once(const Facet& facet, const Vec3& trial) const noexcept {
    return line_of(facet.at_tip(), trial, demand(facet)).holds(proof_slack * tolerance);
  }

  /// Returns true if some normal proves the demand, or the floor if the facet has a plane of its
  /// own: rule 5 (c).
  bool stays_clear(const Facet& facet, const Vec3& trial, bool has_own_plane) const noexcept;

  /// Returns the first contact of a trial with the facet, at plane_level; see first_contact.
  Contact contact(const Facet& facet, const Vec3& trial, double latest) const noexcept;

  /// Returns true if the trial comes so close to the point that a contact touched that stays_clear
  /// must return false. Most contacts are of this kind, and this test is fast.
  bool is_beyond_doubt(const Contact& contact, const Facet& facet,
                       const Vec3& trial) const noexcept;

  /// Returns the plane for a facet in the way: that of the contact, which allows standing still. If
  /// there is an accepted motion, the plane that proves it clear, turned towards the trial's end.
  HalfSpace plane_for(const Facet& facet, const CycleProblem& problem, const Vec3& trial,
                      const HalfSpace& contact) const noexcept;

  /// Turns a facet's plane towards the normal at the end of a motion, as far as it still allows the
  /// kept motion and standing still (Lemma 7).
  HalfSpace turned(const HalfSpace& plane, const Facet& facet, const Vec3& kept,
                   const Vec3& towards) const noexcept;

  /// See ActivationRule::add_alternatives.
  void add_alternatives(const Facet& facet, HalfSpaceBuffer& planes) const noexcept;
};

/// Returns true if the accepted motion is so far from a plane that the plane has not shaped it.
bool is_idle(const HalfSpace& plane, const CycleProblem& problem) noexcept;

/// Returns the distance that an opening reports: that of the nearest facet if it is within the
/// clearance, or a little beyond. Within that all kinds of index show all triangles: the region is
/// larger by `region_beyond` tolerances, and the filter of floats clears no triangle nearer than
/// its level less a fraction of 9e-7. Beyond, one kind may show triangles that another does not.
/// Empty if there is no facet.
std::optional<double> known_distance(const Facet* nearest, double clearance,
                                     double tolerance) noexcept;

}  // namespace keepout
