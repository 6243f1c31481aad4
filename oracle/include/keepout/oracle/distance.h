// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>

#include "keepout/monitor/distance.h"

namespace keepout::oracle {

// The oracle is built on the double arithmetic of the monitor, and adds exact decisions.
using namespace monitor;

/// The distance of a segment from a triangle. Only `distance` is rounded.
struct ExactDistance {
  std::strong_ordering against_zero;       // equal: they touch; never less
  std::strong_ordering against_threshold;  // less: nearer than the threshold
  double distance;  // [length], within 4 units in the last place; 0 if and only if they touch
};

/// Returns the distance of the exact real numbers that the doubles represent. The squared distance
/// is a rational function of the coordinates, so integers suffice: see exact_distance.cpp. Any
/// segment and triangle are valid: a point, a needle, corners on a line, any offset. Takes about 10
/// µs and allocates: for cases that bracket_distance() does not decide. Preconditions: coordinates
/// are finite; threshold [length] is finite and >= 0.
ExactDistance exact_distance(const Segment& segment, const Triangle& triangle, double threshold);

/// Like bracket_distance(), but always narrow: calls exact_distance() if double arithmetic does not
/// suffice. low and estimate are 0 if and only if the two touch. Preconditions: as
/// exact_distance().
Bracket narrow_distance(const Segment& segment, const Triangle& triangle);

}  // namespace keepout::oracle
