// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>

#include "keepout/geometry/triangle.h"
#include "keepout/oracle/segment.h"

namespace keepout::oracle {

/// How far a segment is from a triangle, without any rounding but that of `distance`.
struct ExactDistance {
  std::strong_ordering against_zero;       // equal: they touch; never less
  std::strong_ordering against_threshold;  // less: nearer than the threshold
  double distance;  // [length], within 4 units in the last place; 0 if and only if they touch
};

/// Decides for the real numbers that the doubles stand for. The squared distance is a rational
/// function of the coordinates, so integers suffice: see exact_distance.cpp. Any segment and any
/// triangle will do: a point, a needle, corners on a line, any offset.
/// Preconditions: finite coordinates; threshold [length] finite and >= 0.
/// About 10 us, and allocates: for what bracket_distance() leaves open.
ExactDistance exact_distance(const Segment& segment, const Triangle& triangle, double threshold);

}  // namespace keepout::oracle
