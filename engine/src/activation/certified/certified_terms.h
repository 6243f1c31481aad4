// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/facet.h"
#include "keepout/activation/first_contact.h"
#include "straight_clearance.h"

namespace keepout {

// From a plane turned less than this a motion gains less, as a share of it, than is worthwhile.
inline constexpr double least_turn = 1e-6;

// Of a proof, in units of the tolerance.
inline constexpr double proof_slack = 1.0 / 64.0;

/// What a certified cycle asks of each triangle. It is decided by these functions of
/// one triangle, the trial and the planes at hand, and by nothing else: so the answers are the
/// same, bit for bit, in whatever order the triangles come.
struct CertifiedTerms {
  double tolerance;    // tau: see CertifiedRule::tolerance [length]
  double clearance;    // planes are placed this far off [length]
  double most_demand;  // a trial that comes closer than this is objected to, [length]
  double most_floor;   // ... and one that a triangle's plane allows may come down to this; [length]
                       // neither is asked of a triangle that is closer already
  double lift;         // how far a tip is led off that is too close; else 0 [length]
  double strict;  // what of a proof's slack is taken back then, so that nothing adds up [length]

  /// For a tip that keeps the margin.
  static CertifiedTerms keeping(double margin, double tolerance) noexcept;

  /// For a tip that is too close: the mesh shall not come closer than its nearest triangle, and
  /// what is as close shall be led off by `lift`, a tolerance or more. What is a little farther off
  /// shall not come as close, either: what is lost to rounding at one triangle comes back before it
  /// is lost at another.
  static CertifiedTerms leading_off(double nearest, double lift, double tolerance) noexcept;

  double demand(const Facet& facet) const noexcept { return std::min(most_demand, held(facet)); }
  double floor(const Facet& facet) const noexcept { return std::min(most_floor, held(facet)); }

  /// What of a facet's distance a motion shall not take away.
  double held(const Facet& facet) const noexcept {
    return strict == 0.0 ? facet.distance() : strict - facet.at_tip().support;
  }

  /// The planes contradict each other: leads off by an eighth, and in the end not at all.
  bool relax(HalfSpaceBuffer& planes) noexcept;

  /// Whether a plane at hand proves that the trial keeps clear of a triangle, given by its corners
  /// relative to the tip.
  bool is_covered(const Triangle& corners, const Vec3& trial,
                  std::span<const HalfSpace> planes) const noexcept;

  /// Whether the plane across the way from the tip to a facet proves it, which is told soonest.
  bool is_clear_at_once(const Facet& facet, const Vec3& trial) const noexcept {
    return clears_at_once(facet, trial, demand(facet), proof_slack * tolerance);
  }

  /// Whether the trial keeps clear of a facet. `answered`: the planes have its own among them.
  bool keeps_clear(const Facet& facet, const Vec3& trial, bool answered) const noexcept;

  /// Where a trial that does not keep clear first meets the facet; see first_contact.
  Contact contact(const Facet& facet, const Vec3& trial, double latest) const noexcept;

  /// Whether the trial so clearly comes too close to what a contact has touched that keeps_clear is
  /// bound to say no. Most contacts are of this kind, and this is told at once.
  bool is_beyond_doubt(const Contact& contact, const Facet& facet,
                       const Vec3& trial) const noexcept;

  /// The plane for a facet in the way: that of the contact, which allows standing still. Where a
  /// motion is to be kept, the plane that proves it clear, turned to where the trial ends.
  HalfSpace answer(const Facet& facet, const CycleProblem& problem, const Vec3& trial,
                   const HalfSpace& contact) const noexcept;

  /// Turns a facet's plane towards the normal at the end of a motion, as far as it goes on allowing
  /// what is kept, and standing still.
  HalfSpace turned(const HalfSpace& plane, const Facet& facet, const Vec3& kept,
                   const Vec3& towards) const noexcept;

  /// See ActivationRule::ways_around.
  void ways_around(const Facet& facet, HalfSpaceBuffer& ways) const noexcept;
};

/// Whether an accepted motion is so far from a plane that the plane has not shaped it.
bool is_idle(const HalfSpace& plane, const CycleProblem& problem) noexcept;

/// What an opening tells of the distance: that of the nearest facet at hand, unless the tip is
/// farther off than the margin, or than what a motion along a plane leaves of rounding. So near all
/// forms ask about all triangles: the ball of the region goes `region_beyond` tolerances farther,
/// and the filter of floats clears no triangle nearer than its margin, less a share of 9e-7. Of
/// those beyond, one form may have met what another has not. Null if there is no facet.
std::optional<double> known_distance(const Facet* nearest, double margin,
                                     double tolerance) noexcept;

}  // namespace keepout
