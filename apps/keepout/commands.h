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

namespace keepout::app {

// The smaller commands and their options. Each larger command has a folder.

struct InspectOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  bool json = false;
  bool self_intersections = false;  // takes seconds; the other checks take a fraction of a second
  std::optional<std::filesystem::path> page = {};  // to write: the mesh and its faults
  std::string command = {};                        // the whole command line, for the page
};

/// Reads a mesh file and prints its contents, its faults and their places, as text or as JSON.
/// Throws Error if the file cannot be read or the page cannot be written. Faults of the mesh are
/// not an error.
void inspect(const InspectOptions& options, std::ostream& out);

struct DocsOptions {
  std::string page;  // "serve" for serve.md; empty for all pages
};

/// Returns the names of the documentation pages, sorted; empty if there is no documentation.
std::vector<std::string> pages_of_docs();

/// Prints the path of a documentation page, or the paths and titles of all pages. Throws Error if
/// there is no documentation.
void docs(const DocsOptions& options, std::ostream& out);

struct ConvertOptions {
  std::filesystem::path input;   // a mesh
  std::filesystem::path output;  // the file to write: .stl or .ply
  LoadOptions load = {};
  bool orient = false;  // see Orientation
};

/// Returns why a file of this name cannot be a mesh to write; empty if it can.
std::string fault_of_output(const std::filesystem::path& output);

/// Reads a mesh and writes it again: welded, without faulty triangles and, on request, oriented.
/// Prints all changes, and the parts whose orientation it could not decide. Throws Error, also if
/// the output would overwrite the input, or if no triangle is left.
void convert(const ConvertOptions& options, std::ostream& out);

struct RegisterOptions {
  std::filesystem::path fiducials = {};
  LengthUnit unit = LengthUnit::millimetre;        // of the measured points
  std::vector<double> targets = {};                // x, y, z of each, in the mesh [mm]
  std::optional<double> fle = {};                  // fiducial localization error [mm]
  double confidence = 0.99;                        // of the margin
  std::optional<std::filesystem::path> json = {};  // the file to write
  bool trusted_anyway = false;                     // exit with success even if the fit is doubtful
};

/// Fits the points of a file. Prints the matrix, the residuals of the pairs, and the expected error
/// of the registration at the targets. Prints a doubt about the fit on stderr first. Returns the
/// exit status: failure if there is a doubt, unless `trusted_anyway` is set. Throws Error, also if
/// the JSON file would overwrite the input.
int register_fiducials(const RegisterOptions& options, std::ostream& out);

enum class Loop : std::uint8_t {
  open,   // each line is a tip and a desired increment
  closed  // each line is a goal and a reset position; the tip follows the solved increments
};

struct ReplayOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  std::filesystem::path poses;
  std::filesystem::path steps;                  // STEPS.csv, the file to write
  std::optional<std::filesystem::path> planes;  // PLANES.csv: all planes of each step
  MotionConstraintSettings constraint{.options = {.distances = Distances::always}};
  std::vector<std::string> guides = {};  // texts of guides of the tip
  Loop loop = Loop::open;
  double max_step = 1.0;  // longest desired increment in a closed loop [mm]
};

/// Runs one step for each line of a pose file and writes the results. Prints a summary to `out`. A
/// StopSignal ends the run early; the finished steps are written. Returns the exit status. Throws
/// Error, also if one file would overwrite another; then it writes neither.
int replay(const ReplayOptions& options, std::ostream& out);

}  // namespace keepout::app
