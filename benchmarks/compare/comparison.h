// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "shared/columns.h"

namespace keepout::app {

/// Whether whoever asked for the work wishes it to end.
using Stopped = std::function<bool()>;
inline bool never() { return false; }

/// How thoroughly to compare.
struct CompareExtent {
  std::size_t poses = 60;        // for the indices, under each rule
  std::size_t problems = 2'000;  // for the solvers
  std::size_t pairs = 500;       // of tool and triangle, of each kind, for the narrow phases
  std::uint64_t seed = 1;
};

/// One index under one rule in a motion constraint as it is shipped, on the same poses as all
/// others, held to brute force.
struct IndexAgreement {
  std::string mesh = {}, index = {}, activation = {};
  bool searched = false;     // by a form of the rule that asks no query of it
  std::size_t poses = 0;     // each for one query and one step
  std::size_t missed = 0;    // triangles in reach that it did not give
  std::size_t invented = 0;  // triangles it gave twice, or that are not in reach, after refining
  double closest_point_error = 0.0;   // against exact arithmetic, the worst [mm]
  double plane_angle = 0.0;           // against brute force, the worst [rad]
  double step_difference = 0.0;       // against brute force, the worst [mm]
  std::size_t steps_that_differ = 0;  // in any bit, of the motion or of a plane
};

/// One solver on recorded problems.
struct SolverAgreement {
  std::string solver, activation;
  std::size_t posed = 0;     // problems that were recorded
  std::size_t problems = 0;  // of them, those that it got, evenly spread
  std::size_t optimal = 0;
  std::size_t infeasible = 0;
  std::size_t gave_up = 0;
  std::size_t wrong = 0;         // said optimal or infeasible where it was not
  double step_difference = 0.0;  // of the optimal ones, against active_set, relative to the reach
  double kkt_residual = 0.0;     // of the optimal ones, the worst
  double median_us = 0.0;
  double p99_us = 0.0;
  std::map<std::string, std::size_t> outcomes = {};  // what the library said, and what we found
};

/// A pair this close to a touch, on either side of it, is "touching": whether it is apart or
/// overlaps is finer than the tolerance of most libraries.
inline constexpr double touch = 1e-6;  // [mm]
inline constexpr const char* touch_text = "1e-6 mm";

/// One way to tell the distance between a convex tool and a triangle.
struct NarrowPhaseAgreement {
  std::string backend, tool;
  std::string relation;  // "apart", "touching" (see touch), "overlapping"
  std::size_t pairs = 0;
  std::size_t failed = 0;        // no answer, or one that is no number
  std::size_t contradicted = 0;  // apart called overlapping, or the reverse
  double median_error = 0.0;     // of distance or depth, against the exact kernel [mm]
  double worst_error = 0.0;      // [mm]
  double worst_unproven = 0.0;   // of the exact distance, by a plane with its normal [mm]
  double median_us = 0.0;
  double p99_us = 0.0;
};

struct Comparison {
  bool complete = true;  // not if it was interrupted: then the rows that were finished
  std::vector<IndexAgreement> indices;
  std::vector<SolverAgreement> solvers;
  std::vector<NarrowPhaseAgreement> narrow_phases;
};

/// Returns true if no index differs in any bit and no solver is wrong. The narrow phases are not
/// keepout's, and may differ.
bool agree(const Comparison& comparison);

/// Returns a sentence on whether the parts agree, with the numbers of those that do not.
std::string headline(const Comparison& comparison);

/// Tables for a terminal, and the headline. Parts that were not compared are left out.
void print(std::ostream& out, const Comparison& comparison);

/// The record of it, as docs/records.md describes it; null where nothing was compared.
Json json_of(const Comparison& comparison);

}  // namespace keepout::app
