// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "path.h"

namespace keepout::trial {

/// The sight and the touch of a cycle. Lengths are relative to the intended place along the path.
struct Seen {
  double ahead, across;  // of the intended place, along the heading of the path and across [mm]
  double depth;          // below the path [mm]
  double above;          // height of the intended place during the approach [mm]
  double push;           // force of the fixture away from the bone [N]
};

/// The course and the operator, as a hand needs them.
struct HandSettings {
  double period, speed, depth, length, force_per_mm, felt_force, reaction;
  bool cutting, fixture;
};

/// Decides where the tip should be.
class Hand {
 public:
  virtual ~Hand() = default;
  /// Returns the intended place. Called once in each cycle.
  virtual Coordinates aim(int cycle, int approach) = 0;
  /// Looks at the tip at the end of the cycle.
  virtual void look(const Seen& seen) = 0;
};

/// Rows of numbers, row by row.
struct Table {
  std::vector<double> numbers;
  std::size_t rows, columns;

  double operator()(std::size_t row, std::size_t column) const {
    return numbers[row * columns + column];
  }
  /// Returns the linear interpolation of the first two columns at a place in units of rows.
  std::array<double, 2> interpolated(double place) const;
};

/// The hand of experiments/open_loop.py.
struct OpenLoop {
  double tolerance, leaning, samples;
  Table errors;
};

/// The hand of experiments/intermittent.py.
struct Intermittent {
  double refractory, movement, noise, drift, sight_across, sight_in_depth, lasting, tolerance;
  double touch, lift;
  std::array<double, 3> heading;
  Table motor, sight, view;  // `looks` rows of motor and sight in each millimeter
  std::size_t looks;
};

std::unique_ptr<Hand> make_hand(OpenLoop hand, const HandSettings& settings);
std::unique_ptr<Hand> make_hand(Intermittent hand, const HandSettings& settings);

}  // namespace keepout::trial
