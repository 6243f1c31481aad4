// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout::app {

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
  MotionConstraintSettings constraint;
  Loop loop = Loop::open;
  double max_step = 1.0;  // longest increment asked for in a closed loop [mm]
};

/// Runs one step for each line of a pose file and writes what came out. A summary goes to `out`.
/// Throws Error, also when one file would overwrite another; then neither is written.
void replay(const ReplayOptions& options, std::ostream& out);

}  // namespace keepout::app
