// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

#include "bench/speed/pinned.h"
#include "bench/speed/speed_record.h"
#include "bench/speed/stepper.h"
#include "keepout/fixtures/random.h"
#include "progress.h"

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

struct SpeedSettings {
  std::size_t triangles = 1'000'000;        // of the bunny
  std::size_t larger = 16;                  // times as many, for the rows of large meshes
  std::optional<std::size_t> largest = {};  // triangles of a third; none: left out
  std::string file = "skull_1m";            // fixture that is loaded
  std::size_t histogram_steps = 10'000'000;
  Effort effort = thorough;
  std::uint64_t seed = 1;
};

/// Figures that other rows are set against: medians. [us]
struct Baselines {
  std::optional<MeasuredSide> libraries = {};  // FCL's tree and SLSQP, the paper's rule at 5 mm
  std::optional<MeasuredSide> contact = {};    // certified, ours
  std::optional<MeasuredSide> free = {};       // the same, in free space
};

/// One run of the table, as its families of rows are measured one after the other.
struct SpeedRun {
  const SpeedSettings& settings;
  const Pinned& pinned;
  Progress& progress;
  std::ostream& out;
  SpeedRecord record = {};
  Baselines baselines = {};

  /// The same motions for whoever asks for them.
  Random random() const { return Random(settings.seed); }

  /// Says what is being measured.
  void show(const std::string& work);

  /// Takes down a row, and prints it.
  void add(SpeedRow row);
};

/// numerator / denominator, of the medians. Where a side is missing, so is the figure.
SpeedRow ratio(std::string work, std::string compared, const Demand& demand,
               const std::optional<MeasuredSide>& numerator,
               const std::optional<MeasuredSide>& denominator);

constexpr Demand at_least(double value) { return {Demand::Sense::at_least, value}; }
constexpr Demand at_most(double value) { return {Demand::Sense::at_most, value}; }

}  // namespace keepout::app
