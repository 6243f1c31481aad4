// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/robot/instrument.h"
#include "keepout/status.h"
#include "keepout/step/guide.h"
#include "shared/timing.h"

namespace keepout::app {

/// The outcome of the motion that the operator commanded in one cycle.
enum class Outcome : std::uint8_t {
  moved_freely,  // all of the motion was allowed
  limited,       // a part of the motion was allowed
  stopped        // no motion, or less than a nanometer of a tip
};

/// Returns the outcome of a step with a status. `has_moved`: false if the tool stood still.
constexpr Outcome outcome_of(bool has_moved, Status status) {
  if (!has_moved) return Outcome::stopped;
  return status == Status::free ? Outcome::moved_freely : Outcome::limited;
}

/// The result of one control cycle of a simulated stroke. A tip is one body; an instrument has one
/// or more.
struct Cycle {
  static constexpr double far = std::numeric_limits<double>::infinity();
  static constexpr std::size_t most_bodies = Instrument::most_bodies;
  /// Returns the clearances of bodies that are far away, or do not exist.
  static constexpr std::array<double, most_bodies> all_far() {
    std::array<double, most_bodies> clearances{};
    clearances.fill(far);
    return clearances;
  }

  std::array<Vec3, most_bodies> places;  // the ends of the bodies [mm]
  std::array<Vec3, most_bodies> begins;  // the other ends of the bodies of an instrument [mm]
  /// The least distance of each body to the surface, measured independently: negative inside, never
  /// negative for a tip beside an open surface, infinite beyond the margin of an instrument. [mm]
  std::array<double, most_bodies> clearances = all_far();
  /// The largest distance of each body of a measured instrument from its setpoint. [mm]
  std::array<double, most_bodies> errors{};
  float step_us = 0.0F;  // time of a tip's step; 0 without a guard [µs]
  Outcome outcome = Outcome::moved_freely;
  /// A tip crossed a triangle, a convex tool touched one, a joint left its limits, or the judge
  /// could not decide the motion of an instrument.
  bool is_breach = false;
  bool is_guide_left = false;  // by more than guaranteed
  double guide_excess =
      -far;  // largest of a tip's guides at the end; -infinity without guides [mm]
  std::uint32_t guides_inside = 0;  // a bit for each guide: inside as the cycle began

  /// Returns the smallest clearance; NaN if any clearance is NaN, because then no clearance is
  /// proved.
  double least() const {
    const auto unknown = std::ranges::find_if(clearances, [](double c) { return std::isnan(c); });
    return unknown != clearances.end() ? *unknown : *std::ranges::min_element(clearances);
  }
};

/// The clearances at the start of a stroke. [mm]
struct StrokeStart {
  double required = 0.0;       // by the guard
  double actual = Cycle::far;  // of the nearest body
};

/// The cycles in which a body was too close.
struct BodyTally {
  std::size_t below = 0;      // closer than required
  std::size_t in_mesh = 0;    // of these: cycles in which the body reached into the mesh
  double deepest = 0.0;       // of these: the greatest depth [mm]
  double least = Cycle::far;  // smallest clearance; infinite beyond the margin [mm]
  double error = 0.0;         // largest distance from the setpoint [mm]

  void add(double clearance, double required, double from_setpoint = 0.0);
};

/// The results of all strokes on a mesh, at one speed, under one guard.
struct RunTally {
  std::string mesh = {};
  double speed = 1.0;
  std::string guard = {};
  std::size_t strokes = 0, cycles = 0;
  std::array<std::size_t, 3> outcomes = {};  // cycles, by outcome
  std::size_t breaches = 0;                  // cycles with a breach
  std::size_t guides_left = 0;               // cycles in which a guide was left
  double farthest_out = -Cycle::far;         // largest excess of a tip's guides [mm]
  std::uint32_t guides_inside = 0;           // a bit for each guide: inside in any cycle
  std::size_t strokes_inside = 0;            // with at least one cycle inside
  std::size_t strokes_breached = 0;          // with a cycle inside, or with a breach
  std::size_t starts_too_close = 0;          // strokes that began closer than required
  BodyTally any = {};                        // all bodies together
  std::array<BodyTally, Cycle::most_bodies> bodies = {};
  double least = Cycle::far;  // smallest clearance [mm]
  std::vector<double> times_us = {};

  void add(const std::vector<Cycle>& stroke, const StrokeStart& start);

  std::size_t with(Outcome outcome) const { return outcomes[static_cast<std::size_t>(outcome)]; }
  bool kept_out() const noexcept { return strokes_breached == 0; }
  /// Returns true if the tool moved in no cycle, so that the guard was not tested.
  bool stood_still() const { return cycles > 0 && with(Outcome::stopped) == cycles; }
};

/// Returns Cycle::guides_inside, from the guides of a step.
std::uint32_t guides_inside(std::span<const GuideState> guides);

/// Returns the guides that no guarded tool was ever inside, in quotation marks. `texts`: of all.
std::vector<std::string> untested_guides(std::span<const RunTally> runs,
                                         std::span<const std::string> texts);

/// Returns a sentence on untested guides, after a space; empty without untested guides.
std::string sentence_on_untested(const std::vector<std::string>& guides);

}  // namespace keepout::app
