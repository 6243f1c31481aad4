// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "shared/columns.h"

namespace keepout::app {

/// What became of the motion that the hand asked for in one cycle.
enum class Outcome : std::uint8_t {
  moved_freely,  // all of it was allowed
  limited,       // a part of it was
  stopped        // none of it was, or less than a nanometre
};

/// One control cycle of a simulated stroke, as it ended.
struct Cycle {
  Vec3 hand = Vec3::Zero();  // where the hand would have the tip [mm]
  Vec3 tip = Vec3::Zero();   // where the tip went [mm]
  /// Distance of the tip to the surface, by the independent check: negative inside the anatomy, and
  /// never negative when the surface is open. [mm]
  double clearance = 0.0;
  float step_us = 0.0F;  // time that the step took; 0 where there is no fixture [us]
  Outcome outcome = Outcome::moved_freely;
};

struct Stroke {
  std::vector<Cycle> cycles = {};
};

/// One cycle of a run.
struct Moment {
  std::size_t stroke = 0;
  std::size_t cycle = 0;
};

/// All strokes under one rule.
struct Run {
  std::string rule = {};         // "none", "all_faces", "paper", ...
  std::string description = {};  // one line for a reader who does not know the rule; may be empty
  std::vector<Stroke> strokes = {};
  /// The cycles in which a move of the tip ended that passed through a triangle, in their order.
  std::vector<Moment> crossings = {};
};

/// The rule name of the run without a fixture.
inline constexpr const char* no_rule = "none";

/// The figures of a run. Percentiles are by nearest rank: a time that did occur; 0: not timed.
struct RunSummary {
  std::size_t strokes = 0;
  std::size_t cycles = 0;
  std::size_t moved_freely = 0, limited = 0, stopped = 0;  // cycles, by outcome

  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;  // of the step time [us]
  double rate_khz = 0.0;  // how often the median step fits into a millisecond [kHz]

  double closest_approach = 0.0;     // 0 as soon as the tip has been inside, or crossed [mm]
  double deepest_penetration = 0.0;  // 0 when the tip never was inside [mm]
  std::size_t cycles_inside = 0;
  std::size_t strokes_inside = 0;  // with at least one cycle inside
  std::size_t crossings = 0;
  std::size_t strokes_breached = 0;  // with a cycle inside, or with a crossing

  bool kept_out() const noexcept { return strokes_breached == 0; }
};

RunSummary summarize(const Run& run);

enum class SurfaceKind : std::uint8_t { closed, open };

/// Everything that is told of.
struct Simulation {
  std::string mesh_name;
  const Mesh* mesh = nullptr;  // [mm]; must outlive this
  SurfaceKind surface = SurfaceKind::closed;
  double margin = 0.0;             // what the rules were asked to keep from the surface [mm]
  double cycle_seconds = 0.001;    // length of a control cycle [s]
  Vec3 up = Vec3::UnitZ();         // which way is up in the pictures; head-wards in CT data
  std::string command = {};        // that does it again
  Json settings = Json::object();  // seed, radius, solver, ...
  std::vector<Run> runs = {};      // same strokes, same hand; the run without a fixture first
};

/// True if a tip at this distance from the surface touches it: the check tells no less apart. [mm]
bool touches(double clearance);

/// The figures as a record has them: null for times of what was not timed, and for the inside of an
/// open surface.
Json json_of(const RunSummary& summary, SurfaceKind surface);

/// The figures of each run, a line each.
void print_table(std::ostream& out, const Simulation& simulation);

/// One run in a few words: "went up to 1.2 mm deep, in 3 of 24 strokes".
std::string outcome_of(const RunSummary& summary, SurfaceKind surface);

/// The record of a simulation: see docs/records.md; benchmark and comparison are null. Throws Error
/// when there is no mesh, no run, or a stroke without a cycle, or when runs differ in their
/// strokes.
Json record_of(const Simulation& simulation);

}  // namespace keepout::app
