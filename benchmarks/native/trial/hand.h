// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "path.h"

namespace keepout::trial {

/// The sight and the touch of a cycle, relative to the intended place. [mm, N]
struct Seen {
  double ahead, across, depth, above, push;
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

/// experiments/open_loop.py in C++: the same operations in the same order.
struct OpenLoop {
  double tolerance, leaning, samples;
  Table errors;
};

/// experiments/intermittent.py in C++: the same operations in the same order.
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
