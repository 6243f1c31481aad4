// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace keepout::app {

/// One index under one rule, on the same poses as all others, held to brute force.
struct IndexAgreement {
  std::string mesh = {}, index = {}, activation = {};
  std::size_t poses = 0;
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
  std::size_t problems = 0;
  std::size_t optimal = 0;
  std::size_t infeasible = 0;
  std::size_t gave_up = 0;
  std::size_t wrong = 0;         // said optimal or infeasible where it was not
  double step_difference = 0.0;  // of the optimal ones, against active_set, relative to the reach
  double kkt_residual = 0.0;     // of the optimal ones, the worst
  double median_us = 0.0;
  double p99_us = 0.0;
  std::map<std::string, std::size_t> outcomes;  // what the library said, and what we found
};

/// One way to tell the distance between a convex tool and a triangle.
struct NarrowPhaseAgreement {
  std::string backend, tool;
  std::string relation;  // "apart", "touching" (within 1e-6 mm), "overlapping"
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
  std::vector<IndexAgreement> indices;
  std::vector<SolverAgreement> solvers;
  std::vector<NarrowPhaseAgreement> narrow_phases;
};

}  // namespace keepout::app
