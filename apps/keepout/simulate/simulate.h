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
  Json benchmark, comparison;    // for the record; null without timings
  std::size_t combinations = 0;  // rows of the benchmark
  bool complete = true;          // false if a signal stopped it
  bool is_wrong = false;         // a part gave a wrong answer
};

/// Times all parts on a mesh until a signal comes. Prints tables to `out`.
using TimeParts = std::function<PartTimings(const SimulateOptions& options,
                                            const std::shared_ptr<const Mesh>& mesh,
                                            const StopSignal& stop, std::ostream& out)>;

/// Returns the instrument of options.robot as a simulated tool.
using MakeInstrument =
    std::function<std::unique_ptr<SimulatedTool>(const SimulateOptions& options)>;

struct SimulateOptions {
  std::vector<std::filesystem::path> meshes;  // one; with a robot any number
  LoadOptions load = {};
  RecordFiles files = {.json = {}, .page = "keepout-report.html"};
  std::vector<std::string> rules;       // run in addition to the unguarded tool
  MotionConstraintSettings constraint;  // its activation is replaced by each rule in turn
  std::vector<std::string> guides;      // texts: guides of the tip, or of the robot's links
  StrokeSettings strokes;
  double max_step = 0.5;                // longest increment commanded in a cycle [mm]
  TimeParts time_parts = {};            // unset in a program that cannot time parts
  MakeInstrument make_instrument = {};  // unset in a program that simulates a tip only
  bool is_timing_parts = false;         // run time_parts after the simulation
  bool is_verbose = false;              // print the tables of these timings
  std::string robot;             // whose instrument is driven, see chosen_robot; empty: a tip
  std::filesystem::path bodies;  // of the robot of a URDF file
  std::string notice;            // a sentence that the page must show
  std::vector<double> speeds{1.0, 5.0};  // of a robot, in multiples of 0.5 mm and 0.02 rad a cycle
  bool has_physics = false;              // simulate the robot's masses and servos as well
  std::string called_as = "keepout";     // for the suggestions at the end; empty: no suggestions
  std::string command;                   // the command that repeats the simulation
};

/// Moves a tip, or the instrument of a robot, over and into the anatomy in closed loop, without a
/// guard and with each guard, and judges each cycle. Writes a record of the kind simulate or
/// simulate_robot (docs/records.md) and its report. Prints the outcome and suggestions. Runs a rule
/// that is named twice once.
///
/// A StopSignal ends the simulation within a cycle. The finished strokes are reported; if no stroke
/// is finished, nothing is written. Throws Error, also if the report would overwrite the mesh; then
/// there is no report.
///
/// Returns the exit status; after a signal, exit_interrupted. It is a failure if a certified cycle
/// broke a guarantee of docs/joint-space-step.md, or if a guarded tip left a guide. It is a failure
/// as well if a guarded convex tool touched the surface, or if a timed part gave a wrong answer. It
/// is also a failure if nothing was tested: no guarded tool moved, or no tool was inside a guide.
int simulate(const SimulateOptions& options, std::ostream& out);

}  // namespace keepout::app
