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
#include "operators/strokes.h"
#include "record/record.h"
#include "shared/stop_signal.h"

namespace keepout::app {

struct SimulateOptions;
class SimulatedTool;

/// Timings of all indices, rules and solvers on the mesh of a simulation.
struct PartTimings {
  Json benchmark, comparison;    // for the record; null if there are none
  std::size_t combinations = 0;  // rows of the benchmark
  bool complete = true;          // false if a signal stopped it
  bool is_wrong = false;         // some part gave a wrong answer
};

/// Times all parts on a mesh until a signal comes; prints tables to `out`.
using TimeParts = std::function<PartTimings(const SimulateOptions& options,
                                            const std::shared_ptr<const Mesh>& mesh,
                                            const StopSignal& stop, std::ostream& out)>;

/// Makes the instrument of options.robot.
using MakeInstrument =
    std::function<std::unique_ptr<SimulatedTool>(const SimulateOptions& options)>;

struct SimulateOptions {
  std::vector<std::filesystem::path> meshes;  // one; with a robot any number, by default real ones
  LoadOptions load = {};
  RecordFiles files = {.json = {}, .page = "keepout-report.html"};
  std::vector<std::string> rules;       // run beside the tool without a fixture
  MotionConstraintSettings constraint;  // its activation is each of the rules in turn
  std::vector<std::string> guides;      // texts: of the tip, or with a robot of its links
  StrokeSettings strokes;
  double max_step = 0.5;                 // longest increment commanded in a cycle [mm]
  TimeParts time_parts = {};             // unset in programs that cannot
  MakeInstrument make_instrument = {};   // unset in a program that simulates a tip only
  bool is_timing_parts = false;          // whether to do so after the simulation
  bool is_verbose = false;               // prints the tables of these timings
  std::string robot;                     // drives its instrument instead of a tip; empty: a tip
  std::vector<double> speeds{1.0, 5.0};  // of it, in multiples of 0.5 mm and 0.02 rad a cycle
  std::string called_as = "keepout";     // in the suggestions at the end; empty: no suggestions
  std::string command;                   // that does it again
};

/// Moves a tip, or the instrument of a robot, over and into the anatomy in closed loop, without a
/// guard and with each one, and judges each cycle. Writes a record of the kind simulate or
/// simulate_robot (docs/records.md) and its report, and prints the outcome and what to try next. A
/// rule that is named twice runs once.
///
/// A StopSignal ends it within a cycle. The strokes that are finished are kept; without one,
/// nothing is written. Returns the exit status: failure if a certified cycle of an instrument broke
/// what docs/joint-space-step.md promises, if a guarded tip left a guide, if a guarded convex tool
/// touched the surface, or if a part that was timed gave a wrong answer;
/// exit_interrupted if a signal stopped it. Throws Error, also if the report would
/// overwrite the mesh; then there is no report.
int simulate(const SimulateOptions& options, std::ostream& out);

}  // namespace keepout::app
