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

/// On which motion the certificate is taken.
enum class CertifiedMotion : std::uint8_t {
  actual,     // the one that the joints make
  linearised  // of points on straight lines, p + s J dq: what others do. Unsafe; for comparison
              // only
};

/// The names of CertifiedMotion.
inline constexpr std::array<std::string_view, 2> certified_motion_names{"actual", "linearised"};

/// Options of an instrument constraint that stay the same from cycle to cycle. The table below has
/// their ranges.
struct InstrumentOptions {
  /// Distance to keep beyond each body's radius, from all meshes that have no margin of their own,
  /// > band [length]
  double margin = 0.2;
  /// What is held back of the margin, so that curved motions along a surface are proven: certified
  /// is margin - band. A wide band costs progress, never safety. See recommended_band. [length]
  double band = 0.002;
  double period = 1e-3;    // of a cycle: what velocity limits are multiplied by [s], > 0
  double recovery = 0.05;  // how far a body that is too close is led away in a cycle, >= 0 [length]
  /// Bodies come on slower where they are nearer to the margin than that, so that they touch it
  /// softly: a way of d left to it, they use up no more than d period / slowing_time in a cycle.
  /// What comes on is the instrument: a mesh that does is not fled. 0: nowhere. [length]
  double slowing_within = 0.0;
  double slowing_time = 0.05;  // how long the approach takes to come to an end, > 0 [s]
  /// Weight of |dq|^2 beside the task of the flange, >= 0: what singular poses give way to. A
  /// prismatic joint counts as a radian when it moves by orientation_weight, or by a length of 1
  /// where that is 0. [length^2]
  double damping = 0.1;
  /// What a turn of the flange counts beside its way, in lengths, >= 0: a radian off is as bad as
  /// so much. 0: only its origin is steered. [length / rad]
  double orientation_weight = 20.0;
  int refinements = 1;  // how often planes are turned towards a better motion, >= 0
  /// Whether bodies that no step has led to where they are have to be on the free side of a
  /// watertight mesh: by its winding, as tips are (docs/conventions.md).
  bool check_sides = true;
  CertifiedMotion certified = CertifiedMotion::actual;  // nothing else is safe
};

/// The table of these options. The band must also be below each mesh's margin.
inline constexpr std::array instrument_options{
    option<&InstrumentOptions::margin>(
        "margin", "length", positive_length,
        "Clearance to keep beyond each body's radius, from meshes without a margin of their own."),
    option<&InstrumentOptions::band>("band", "length", above_zero(longest_length),
                                     "Curvature allowance: part of the margin that curved motions "
                                     "may use, so that the certified "
                                     "clearance is margin - band; see recommended_band."),
    option<&InstrumentOptions::period>(
        "period", "s", above_zero(1e9),
        "Duration of a cycle, by which velocity limits are multiplied."),
    option<&InstrumentOptions::recovery>("recovery", "length", not_negative,
                                         "Longest retreat in a cycle of a body that is too close."),
    option<&InstrumentOptions::slowing_within>(
        "slowing_within", "length", not_negative,
        "Distance beyond the margin within which bodies approach more slowly; 0: nowhere."),
    option<&InstrumentOptions::slowing_time>(
        "slowing_time", "s", above_zero(1e9),
        "Duration of that approach: a cycle uses up at most period / slowing_time of the distance "
        "left to the margin."),
    option<&InstrumentOptions::damping>("damping", "length^2", not_negative,
                                        "Weight of |dq|^2 beside the task of the flange."),
    option<&InstrumentOptions::orientation_weight>(
        "orientation_weight", "length/rad", not_negative,
        "Weight of a turn of the flange beside its displacement; 0: only its origin is steered."),
    option<&InstrumentOptions::refinements>("refinements", "", {0, 2147483647.0},
                                            "How often cuts are rotated towards a better motion."),
    option<&InstrumentOptions::check_sides>(
        "check_sides",
        "True if bodies that no step has led to where they are must be on the free side of a "
        "watertight mesh."),
    option<&InstrumentOptions::certified, certified_motion_names>(
        "certified",
        "Motion that is certified: the one that the joints make, or a linearized one, which is "
        "unsafe and for comparison only.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentOptions&) { return instrument_options; }

/// Room for the largest cycle.
struct InstrumentCapacity {
  static constexpr std::size_t most_meshes = 8;  // to be kept out of

  std::size_t triangles = std::size_t{1} << 14;  // of one mesh, near one body
  std::size_t planes = 128;                      // posed at the same time
  /// The work of a cycle, whatever happens in it: see Budget. What cannot be proven with it is not
  /// moved. 0: Capacity::looks_of_a_walk on an index that walks by itself, as wide_bvh, and
  /// Capacity::looks_of_queries on others, of which more is asked.
  std::size_t looks = 0;
};

/// The table of these options.
inline constexpr std::array instrument_capacity_options{
    option<&InstrumentCapacity::triangles>("max_triangles", "", {0, 4294967296.0},
                                           "Capacity for the triangles of one mesh near one body."),
    option<&InstrumentCapacity::planes>("max_planes", "", {0, 1 << 30},
                                        "Capacity for the planes of a cycle."),
    option<&InstrumentCapacity::looks>(
        "max_looks", "", {0, static_cast<double>(Budget::unlimited)},
        "Work budget of a cycle, in looks; 0: 65,536 on wide_bvh, 4,194,304 on other indices.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentCapacity&) { return instrument_capacity_options; }

/// A band that absorbs the curvature of every motion that the joints' limits admit in a cycle of
/// `period` > 0 seconds: an eighth of the largest bend of any body's point, at least `least`.
/// Infinite without limits. [length]
double recommended_band(const Instrument& instrument, double period, double least = 0.002);

}  // namespace keepout
