// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "record/record.h"
#include "simulate/hand.h"

namespace keepout::app {

struct SimulateOptions;

/// Timings of all indices, rules and solvers on the mesh of a simulation.
struct PartTimings {
  Json benchmark, comparison;    // for the record; null if there are none
  std::size_t combinations = 0;  // rows of the benchmark
  bool complete = true;          // false if a signal stopped it
};

/// Times all parts on a mesh; prints tables to `out`.
using TimeParts = std::function<PartTimings(
    const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh, std::ostream& out)>;

/// Whether the tables of the report are printed too.
enum class Tables { in_the_report, printed };

struct SimulateOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  RecordFiles files = {.json = {}, .page = "keepout-report.html"};
  std::vector<std::string> rules;       // run beside the tool without a fixture
  MotionConstraintSettings constraint;  // its activation is each of the rules in turn
  HandSettings hand;
  double max_step = 0.5;         // longest increment asked for in a cycle [mm]
  TimeParts time_parts = {};     // unset in programs that cannot
  bool is_timing_parts = false;  // whether to do so after the simulation
  Tables tables = Tables::in_the_report;
  std::string robot;                          // whose instrument is driven instead; empty: none
  std::vector<std::filesystem::path> meshes;  // for it; without one, the largest real ones
  std::vector<double> speeds{1.0, 5.0};       // of it, in multiples of 0.5 mm and 0.02 rad a cycle
  std::string called_as = "keepout";          // what the user is told to type next
  std::string command;                        // that does it again
};

/// Pushes the tool over and into the anatomy in closed loop, without a fixture and with each rule;
/// writes a record and its report, and prints to `out` in a dozen lines what came out and what to
/// try next. A rule that is named twice runs once. Throws Error, also when the report would
/// overwrite the mesh; then there is no report. Gives the exit status: exit_interrupted where a
/// signal stopped the benchmark, of which the report has what was finished.
int simulate(const SimulateOptions& options, std::ostream& out);

/// What `simulate` does where a robot is named: drives its instrument over the meshes in each mode,
/// and judges each cycle; writes a record of the kind simulate_robot (docs/records.md) and its
/// report, and prints a table. A StopSignal ends it early, and what is done is kept. The exit
/// status: failure when a certified cycle broke what docs/joint-space-step.md promises. Throws
/// Error.
int simulate_robot(const SimulateOptions& options, std::ostream& out);

}  // namespace keepout::app
