// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

namespace keepout::app {

/// How much of everything is measured.
struct Effort {
  std::size_t queries;     // places of a sphere query
  std::size_t steps;       // of ours
  std::size_t slow_steps;  // of the libraries
  std::size_t cold_steps;  // between which the caches are emptied
  std::size_t builds;      // of an index
  int passes;              // over the same work, of which the least counts
};

inline constexpr Effort thorough{2000, 20'000, 1500, 500, 3, 3};
inline constexpr Effort quick{200, 1000, 100, 100, 1, 1};

struct SpeedOptions {
  std::size_t triangles = 1'000'000;        // of the bunny
  std::size_t larger = 16;                  // times as many, for the rows of large meshes
  std::optional<std::size_t> largest = {};  // triangles of a third; none: left out
  std::string file = "skull_1m";            // fixture that is loaded
  std::size_t histogram_steps = 10'000'000;
  Effort effort = thorough;
  std::uint64_t seed = 1;
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
