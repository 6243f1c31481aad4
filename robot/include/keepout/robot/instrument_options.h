// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "keepout/index/budget.h"
#include "keepout/option_table.h"
#include "keepout/robot/instrument.h"

namespace keepout {

/// The motion that is certified.
enum class CertifiedMotion : std::uint8_t {
  actual,      // the motion that the joints really make
  linearized,  // points on straight lines, p + s J dq, as in other methods: unsafe, for comparison
  linearised [[deprecated("use linearized")]] = linearized
};

/// The names of CertifiedMotion.
inline constexpr std::array<std::string_view, 2> certified_motion_names{"actual", "linearized"};

/// Options of an instrument constraint that stay the same from cycle to cycle. The table below has
/// their meanings and ranges.
struct InstrumentOptions {
  double margin = 0.2;                                  // [length]
  double band = 0.002;                                  // [length]
  double period = 1e-3;                                 // [s]
  double recovery = 0.05;                               // [length]
  double slowing_within = 0.0;                          // [length]
  double slowing_time = 0.05;                           // [s]
  double damping = 0.1;                                 // [length^2]
  double orientation_weight = 20.0;                     // [length/rad]
  int refinements = 1;                                  // at most
  bool check_sides = true;                              // of watertight meshes
  CertifiedMotion certified = CertifiedMotion::actual;  // the motion that is proved
};

/// The table of these options. The band must also be below each mesh's margin.
inline constexpr std::array instrument_options{
    option<&InstrumentOptions::margin>(
        "margin", "length", positive_length,
        "Required clearance beyond each body's radius, for meshes without their own margin."),
    option<&InstrumentOptions::band>("band", "length", above_zero(longest_length),
                                     "Curvature allowance: part of the margin that curved motions "
                                     "may use, so that the certified clearance is margin - band. A "
                                     "wide band costs progress, never safety."),
    option<&InstrumentOptions::period>(
        "period", "s", above_zero(1e9),
        "Duration of a cycle, by which velocity limits are multiplied."),
    option<&InstrumentOptions::recovery>("recovery", "length", not_negative,
                                         "Longest retreat in a cycle of a body that is too close."),
    option<&InstrumentOptions::slowing_within>(
        "slowing_within", "length", not_negative,
        "Distance beyond the margin within which bodies approach more slowly; 0: nowhere. The "
        "approach of a mesh that moves is not slowed down."),
    option<&InstrumentOptions::slowing_time>(
        "slowing_time", "s", above_zero(1e9),
        "Time constant of that approach: a cycle uses up at most period / slowing_time of the "
        "distance left to the margin."),
    option<&InstrumentOptions::damping>(
        "damping", "length^2", not_negative,
        "Weight of |dq|^2 in the objective of the flange, for singular poses. A displacement of a "
        "prismatic joint by orientation_weight (by 1 if that is 0) counts like 1 rad."),
    option<&InstrumentOptions::orientation_weight>(
        "orientation_weight", "length/rad", not_negative,
        "Weight of the rotation of the flange relative to its displacement; 0: only its origin is "
        "steered."),
    option<&InstrumentOptions::refinements>(
        "refinements", "", {0, 2147483647.0},
        "Most re-linearizations of the planes of rows for a better motion."),
    option<&InstrumentOptions::check_sides>(
        "check_sides",
        "True if bodies must be on the free side of a watertight mesh. A body that a step moved to "
        "its position is not checked."),
    option<&InstrumentOptions::certified, certified_motion_names>(
        "certified",
        "Motion that is certified: the one that the joints make, or a linearized one, which is "
        "unsafe and for comparison only.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentOptions&) { return instrument_options; }

/// Capacity for the largest cycle. The table below has the meanings of the members.
struct InstrumentCapacity {
  static constexpr std::size_t most_meshes = 8;  // of one constraint

  std::size_t triangles = std::size_t{1} << 14;  // of one mesh near one body
  std::size_t planes = 128;                      // rows of a cycle
  /// Work units of a cycle, for all meshes; 0: the largest of the defaults of their indices.
  std::size_t work_units = 0;
  std::size_t looks = 0;  // deprecated: use work_units
};

/// The table of these options.
inline constexpr std::array instrument_capacity_options{
    option<&InstrumentCapacity::triangles>("max_triangles", "", {1, 4294967296.0},
                                           "Capacity for the triangles of one mesh near one body."),
    option<&InstrumentCapacity::planes>("max_planes", "", {1, 1 << 16},
                                        "Capacity for the rows of a cycle, joint limits apart."),
    option<&InstrumentCapacity::work_units>("max_work_units", "",
                                            {0, static_cast<double>(Budget::unlimited)},
                                            "Work budget of a cycle, in work units; 0: 90,112 on "
                                            "wide_bvh, 4,194,304 on other indices.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentCapacity&) { return instrument_capacity_options; }

/// Returns a band that suffices for the curvature of every motion that the joint limits allow in a
/// cycle of `period` > 0 seconds. It is an eighth of the largest second-derivative bound of any
/// body's point, and at least `least`. Infinite if the limits do not bound the curvature. Throws
/// Error for numbers out of range. [length]
double recommended_band(const Instrument& instrument, double period, double least = 0.002);

}  // namespace keepout
