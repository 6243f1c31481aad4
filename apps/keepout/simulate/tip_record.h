// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulate/audit.h"
#include "simulate/subject.h"

namespace keepout::app {

/// The rule name of the run without a fixture, which is the first.
inline constexpr const char* no_rule = "none";

/// All strokes of a tip: what a record shows.
struct TipSimulation {
  std::string mesh_name;
  const Mesh* mesh = nullptr;  // [mm]; must outlive this
  SurfaceKind surface = SurfaceKind::closed;
  double margin = 0.0;             // required clearance of the rules [mm]
  std::string command = {};        // that does it again
  Json settings = Json::object();  // seed, radius, solver, ...
  std::vector<std::string> rules = {};
  std::vector<std::string> descriptions = {};  // of the rules, for a reader who does not know them
  std::vector<FollowedStroke> strokes = {};    // under each rule
};

/// The figures of a run: null for times of what was not timed, and for the inside of an open
/// surface.
Columns<RunTally> tip_columns(SurfaceKind surface);

/// Returns the outcome of a run in a few words: "went up to 1.2 mm deep, in 3 of 24 strokes".
std::string outcome_of(const RunTally& tally, SurfaceKind surface);

/// Returns the record: see docs/records.md; benchmark and comparison are null. `tallies`: one for
/// each rule. Precondition: there are strokes with cycles.
Json record_of(const TipSimulation& simulation, const std::vector<RunTally>& tallies);

}  // namespace keepout::app
