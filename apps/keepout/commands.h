// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "keepout/control/registration.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/step/guide.h"
#include "record/record.h"
#include "simulate/hand.h"

namespace keepout::app {

// What the smaller commands do, and what each is told. The larger ones have folders of their own.

struct InspectOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  bool json = false;
  bool self_intersections = false;  // costs seconds where the rest costs a fraction of one
};

/// Reads a mesh file and prints what it is made of and what is wrong with it, in words or as JSON.
/// Throws Error when the file cannot be read; whatever is found in it is no error.
void inspect(const InspectOptions& options, std::ostream& out);

struct RegisterOptions {
  std::filesystem::path fiducials = {};
  LengthUnit unit = LengthUnit::millimetre;        // of what was measured
  std::vector<double> targets = {};                // x, y, z of each, in the mesh [mm]
  std::optional<double> fle = {};                  // fiducial localisation error [mm]
  double confidence = 0.99;                        // of the margin
  std::optional<std::filesystem::path> json = {};  // to be written
};

/// Fits the points of a file and prints the matrix, what is left between the pairs, and by how much
/// the registration is expected to be off at the targets. Throws Error, also when the file for JSON
/// would overwrite the other.
void register_fiducials(const RegisterOptions& options, std::ostream& out);

enum class Loop : std::uint8_t {
  open,   // each line is a tip and a desired increment
  closed  // each line is a goal and a reset position; the tip follows the solved increments
};

struct ReplayOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  std::filesystem::path poses;
  std::filesystem::path steps;                  // STEPS.csv, to be written
  std::optional<std::filesystem::path> planes;  // PLANES.csv, to be written: all that were posed
  MotionConstraintSettings constraint{.options = {.distances = Distances::always}};
  std::vector<Guide> guides = {};  // that the tip keeps as well
  Loop loop = Loop::open;
  double max_step = 1.0;  // longest increment asked for in a closed loop [mm]
};

/// Runs one step for each line of a pose file and writes what came out. A summary goes to `out`.
/// Throws Error, also when one file would overwrite another; then neither is written.
void replay(const ReplayOptions& options, std::ostream& out);

enum class Timings {
  of_the_run,    // what its own steps took
  of_every_part  // and a quick benchmark of everything that could take its parts' place
};

/// Whether the tables of the report are printed too.
enum class Tables { in_the_report, printed };

struct SimulateOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  RecordFiles files = {.json = {}, .page = "keepout-report.html"};
  std::vector<std::string> rules;       // run beside the tool without a fixture
  MotionConstraintSettings constraint;  // its activation is each of the rules in turn
  HandSettings hand;
  double max_step = 0.5;  // longest increment asked for in a cycle [mm]
  Timings timings = Timings::of_the_run;
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
