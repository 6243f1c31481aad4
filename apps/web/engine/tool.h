// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "anatomy.h"
#include "keepout/robot/instrument.h"

/// Result of a control cycle, as it lies in memory. Valid until the tool's next call.
struct Cycle {
  double positions[8];  // after the cycle: of a tip [mm], or of the joints [rad or mm]
  double motion[8];     // their increment in the cycle
  double asked[6];      // of a tip: the hand's place [mm]; of a flange: motion [mm], rotation [rad]
  double flange[7];     // what the hand leads, after the cycle: place and quaternion x y z w
  double force[3];      // of the spring between hand and tip, on the hand [N]
  double distance = std::numeric_limits<double>::quiet_NaN();  // of the tip, or of the nearest
                                                               // body, before the cycle [mm]
  double cores[6 * keepout::Instrument::most_bodies];  // both ends of each body, after the cycle
  std::uint32_t status;                                // keepout_statuses has its name
  std::uint32_t held;                                  // planes or rows that limit the motion
  std::uint32_t rounds;                                // judged trial motions of an instrument
  std::int32_t nearest = -1;                           // number of that body; -1: not known
  std::uint32_t triangles;                             // that the step of a tip rests on
  std::uint32_t plane_count;
  const keepout::HalfSpace* planes;  // (plane_count), from the tip before the cycle
  const std::uint32_t* active;       // (held): the planes that limit the motion of a tip
};
static_assert(sizeof(void*) == 4 && sizeof(Cycle) == 1064);
static_assert(offsetof(Cycle, motion) == 64 && offsetof(Cycle, asked) == 128);
static_assert(offsetof(Cycle, flange) == 176 && offsetof(Cycle, force) == 232);
static_assert(offsetof(Cycle, distance) == 256 && offsetof(Cycle, cores) == 264);
static_assert(offsetof(Cycle, status) == 1032 && offsetof(Cycle, held) == 1036);
static_assert(offsetof(Cycle, rounds) == 1040 && offsetof(Cycle, nearest) == 1044);
static_assert(offsetof(Cycle, triangles) == 1048 && offsetof(Cycle, plane_count) == 1052);
static_assert(offsetof(Cycle, planes) == 1056 && offsetof(Cycle, active) == 1060);
static_assert(sizeof(keepout::HalfSpace) == 40 && offsetof(keepout::HalfSpace, offset) == 24);
static_assert(offsetof(keepout::HalfSpace, source) == 32);

/// A tool that a hand leads and keepout constrains: the ball of a tip, or a whole instrument.
struct Tool {
  virtual ~Tool() = default;
  /// Puts the tip or the joints there, and forgets the past.
  virtual void place(const double* positions) = 0;
  /// One control cycle towards the hand: its place and a quaternion x y z w, which a tip ignores.
  virtual void follow(const double* hand) = 0;
  /// One step (6): of a tip from a place by an increment, of an instrument by a twist of the
  /// flange.
  virtual void step(const double* asked) = 0;
  /// Returns the distance from the surface of a body to the mesh. Throws if there is no memory.
  /// [mm]
  virtual double clearance(std::size_t body) = 0;

  std::string facts;  // JSON: positions, band, period, bodies with name and radius
  Cycle cycle = {};
};

/// Lengths in mm, stiffness in N/mm, force in N. `max_step`: the tip's longest way in a cycle.
struct TipSettings {
  double radius, tool_radius, margin, max_step, stiffness, largest_force;
};
/// A tip at the origin under a rule; without a constraint for rule "none". Throws Error.
std::unique_ptr<Tool> make_tip(Anatomy& anatomy, std::string_view rule,
                               const TipSettings& settings);

/// `base`: the place of link 0 and the rows of its rotation. Lengths in mm.
struct InstrumentSettings {
  double base[12];
  double margin, max_step;
};
/// The instrument of a named robot. Throws Error.
std::unique_ptr<Tool> make_instrument(const Anatomy& anatomy, std::string_view robot,
                                      const InstrumentSettings& settings);
