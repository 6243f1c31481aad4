// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "hand.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout::app {

enum class Timings {
  of_the_run,    // what its own steps took
  of_every_part  // and a quick benchmark of everything that could take its parts' place
};

/// Whether the tables of the report are printed too.
enum class Tables { in_the_report, printed };

struct SimulateOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  std::filesystem::path report = "keepout-report.html";  // to be written
  std::vector<std::string> rules;                        // run beside the tool without a fixture
  MotionConstraintSettings constraint;  // its activation is each of the rules in turn
  HandSettings hand;
  double max_step = 0.5;  // longest increment asked for in a cycle [mm]
  Timings timings = Timings::of_the_run;
  Tables tables = Tables::in_the_report;
  std::string called_as = "keepout";  // what the user is told to type next
};

/// Pushes the tool over and into the anatomy in closed loop, without a fixture and with each rule;
/// writes a report, and prints to `out` in a dozen lines what came out and what to try next. A rule
/// that is named twice runs once. Throws Error, also when the report would overwrite the mesh; then
/// there is no report. Gives the exit status: exit_interrupted where a signal stopped the
/// benchmark, of which the report has what was finished.
int simulate(const SimulateOptions& options, std::ostream& out);

}  // namespace keepout::app
