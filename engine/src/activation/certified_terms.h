// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "keepout/activation/activation.h"
#include "keepout/activation/facet.h"

namespace keepout {

// From a plane turned less than this a motion gains less, as a share of it, than is worthwhile.
inline constexpr double least_turn = 1e-6;

/// What a certified cycle asks of each triangle. Every form of the rule decides by these functions
/// of one triangle, the trial and the planes at hand, and by nothing else: so all forms answer the
/// same, bit for bit, in whatever order they come by the triangles.
struct CertifiedTerms {
  double tolerance;    // tau: see CertifiedRule::tolerance [length]
  double target;       // planes are placed this far off [length]
  double most_demand;  // a trial that comes closer than this is objected to, [length]
  double most_floor;   // ... and one that a triangle's plane allows may come down to this; [length]
                       // neither is asked of a triangle that is closer already

  /// For a tip that keeps the margin.
  static CertifiedTerms keeping(double margin, double tolerance) noexcept;

  /// For a tip that is too close: the mesh shall not come closer than its nearest triangle, and
  /// what is as close shall be led off by `lift`.
  static CertifiedTerms leading_off(double nearest, double lift, double tolerance) noexcept;

  double demand(const Facet& facet) const noexcept {
    return std::min(most_demand, facet.distance());
  }
  double floor(const Facet& facet) const noexcept { return std::min(most_floor, facet.distance()); }

  /// Whether a plane at hand proves that the trial keeps clear of a triangle, given by its corners
  /// relative to the tip.
  bool is_covered(const Triangle& corners, const Vec3& trial,
                  std::span<const HalfSpace> planes) const noexcept;

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
  HalfSpace answer(const Facet& facet, const Surroundings& around, const Vec3& trial,
                   const HalfSpace& contact) const noexcept;

  /// Turns a facet's plane towards the normal at the end of a motion, as far as it goes on allowing
  /// what is kept, and standing still.
  HalfSpace turned(const HalfSpace& plane, const Facet& facet, const Vec3& kept,
                   const Vec3& towards) const noexcept;

  /// See Activation::turn. `facet(source)` is the facet of a triangle in reach.
  template <class FacetOf>
  bool turn_all(const Surroundings& around, std::span<const HalfSpace> planes, FacetOf&& facet,
                HalfSpaceBuffer& turned_planes) const noexcept;

  /// See Activation::ways_around.
  void ways_around(const Facet& facet, HalfSpaceBuffer& ways) const noexcept;
};

/// Whether an accepted motion is so far from a plane that the plane has not shaped it.
bool is_idle(const HalfSpace& plane, const Surroundings& around) noexcept;

/// What an opening tells of the distance: that of the nearest facet at hand, unless the tip is
/// farther off than the margin, or than what a motion along a plane leaves of rounding. So near all
/// forms ask about all triangles: the ball of the region goes `region_beyond` tolerances farther,
/// and the screen of floats, which clears no triangle nearer than its margin, a share of 9e-7. Of
/// those beyond, one form may have met what another has not. Null if there is no facet.
std::optional<double> known_distance(const Facet* nearest, double margin,
                                     double tolerance) noexcept;

/// See CertifiedRule::tolerance. `longest_edge`: of the mesh. [length]
double certified_tolerance(const Surroundings& around, double longest_edge) noexcept;

/// The ball that a certified cycle asks about: see Activation::region.
Ball certified_region(const Surroundings& around, double tolerance) noexcept;

template <class FacetOf>
bool CertifiedTerms::turn_all(const Surroundings& around, std::span<const HalfSpace> planes,
                              FacetOf&& facet, HalfSpaceBuffer& turned_planes) const noexcept {
  bool changed = false;
  for (const HalfSpace& plane : planes) {
    if (is_idle(plane, around)) continue;
    // One that is not a triangle's but the motion sphere's stays.
    const bool stays = plane.source == no_triangle;
    turned_planes.push(stays ? plane
                             : turned(plane, facet(plane.source), around.kept, around.kept));
    const Vec3 turn = turned_planes[turned_planes.size() - 1].normal - plane.normal;
    changed = changed || turn.squaredNorm() > least_turn * least_turn;
  }
  return changed;
}

}  // namespace keepout
