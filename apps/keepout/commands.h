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
  std::vector<std::string> guides = {};  // texts, of the tip
  Loop loop = Loop::open;
  double max_step = 1.0;  // longest increment asked for in a closed loop [mm]
};

/// Runs one step for each line of a pose file and writes what came out. A summary goes to `out`.
/// Throws Error, also when one file would overwrite another; then neither is written.
void replay(const ReplayOptions& options, std::ostream& out);

}  // namespace keepout::app
