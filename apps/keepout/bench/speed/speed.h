// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "bench/speed/speed_run.h"

namespace keepout::app {

struct SpeedOptions {
  SpeedSettings settings;
  std::filesystem::path report = "keepout-speed.html";  // to be written
  std::optional<std::filesystem::path> json;            // to be written
  std::string command;                                  // that does it again
};

/// Measures the table of ratios that the engine is held to, prints it as it goes, and writes a
/// report and files. What falls short is said, and is no error. A wish to stop ends it after the
/// family of rows at hand: what is measured is written, and said to be a part. The exit status.
/// Throws Error before any work when a file could not be written, or a fixture is missing.
int bench_speed(const SpeedOptions& options, std::ostream& out);

}  // namespace keepout::app
