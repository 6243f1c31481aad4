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

// The smaller commands and their options. Each larger one has a folder.

struct InspectOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  bool json = false;
  bool self_intersections = false;  // costs seconds where the rest costs a fraction of one
  std::optional<std::filesystem::path> page = {};  // of the mesh with its faults, to be written
  std::string command = {};                        // the whole command line, for the page
};

/// Reads a mesh file and prints what it is made of, what is wrong with it and where, in words or as
/// JSON. Throws Error if the file cannot be read or the page cannot be written; faults of the mesh
/// are no error.
void inspect(const InspectOptions& options, std::ostream& out);

struct DocsOptions {
  std::string page;  // "serve" for serve.md; empty: all of them
};

/// Returns the names of the pages of documentation, sorted; none where there is no documentation.
std::vector<std::string> pages_of_docs();

/// Prints where a page of the documentation is, or where all are, with their titles. Throws Error
/// if there is no documentation.
void docs(const DocsOptions& options, std::ostream& out);

struct ConvertOptions {
  std::filesystem::path input;   // a mesh
  std::filesystem::path output;  // .stl or .ply, to be written
  LoadOptions load = {};
  bool orient = false;  // see Orientation
};

/// Returns why no mesh can be written to a file of this name; empty if one can.
std::string fault_of_output(const std::filesystem::path& output);

/// Reads a mesh and writes it again: welded, without faulty triangles and, if asked for, oriented.
/// Prints all that it changed, and what it could not decide. Throws Error, also if the output would
/// overwrite the input, or if no triangle is left.
void convert(const ConvertOptions& options, std::ostream& out);

struct RegisterOptions {
  std::filesystem::path fiducials = {};
  LengthUnit unit = LengthUnit::millimetre;        // of what was measured
  std::vector<double> targets = {};                // x, y, z of each, in the mesh [mm]
  std::optional<double> fle = {};                  // fiducial localisation error [mm]
  double confidence = 0.99;                        // of the margin
  std::optional<std::filesystem::path> json = {};  // to be written
  bool trusted_anyway = false;                     // doubts do not change the exit status
};

/// Fits the points of a file and prints the matrix, what is left between the pairs, and by how much
/// the registration is expected to be off at the targets. Prints a doubt about the fit on stderr
/// first. Returns the exit status: failure if there is a doubt, unless it is trusted anyway. Throws
/// Error, also when the file for JSON would overwrite the other.
int register_fiducials(const RegisterOptions& options, std::ostream& out);

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
  std::vector<std::string> guides = {};  // texts, of the tip
  Loop loop = Loop::open;
  double max_step = 1.0;  // longest increment asked for in a closed loop [mm]
};

/// Runs one step for each line of a pose file and writes what came out. A summary goes to `out`. A
/// StopSignal ends it early, and the steps that are finished are written. Returns the exit status.
/// Throws Error, also when one file would overwrite another; then neither is written.
int replay(const ReplayOptions& options, std::ostream& out);

}  // namespace keepout::app
