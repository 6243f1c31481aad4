// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>

#include "keepout/geometry/shapes.h"

namespace keepout::oracle {

/// The closed straight way from one point to another; the two may coincide. [length]
struct Segment {
  Vec3 from;
  Vec3 to;
};

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

/// What double arithmetic can tell about a distance: low <= the exact distance <= high. [length]
struct Bracket {
  double low;       // >= 0
  double estimate;  // from low to high
  double high;

  /// Whether the estimate is within a billionth of itself.
  bool narrow() const noexcept { return high - low <= 1e-9 * estimate; }
};

/// Brackets the distance between a segment and a triangle, both possibly degenerate; some 100 ns.
///
/// The width is proven after the fact, pair by pair, and so needs no case analysis of needles and
/// near parallels. Let the size S be the largest 1-norm among corner - from and to - from.
/// - `high`: two points, one of each, are no nearer than the two sets. However badly they were
///   found, their distance is evaluated with an error of a few roundings of S.
/// - `low`: for any direction n the sets are at least (min over the segment - max over the
///   triangle of n . x) / |n| apart. However badly n was found, that too is evaluated with an error
///   of a few roundings of S.
/// Both errors are below 2^-48 S (bracket_distance.cpp derives it). The estimate is the distance of
/// the two points. If they and n are well found, as nearly always, the bracket is about 2^-47 S
/// wide. If not, as where the two all but touch or S is beyond
/// 1e-70 .. 1e70, it is wide, and exact_distance() has to decide.
Bracket bracket_distance(const Segment& segment, const Triangle& triangle) noexcept;

/// The same, always narrow: by exact_distance() where double arithmetic does not suffice. low and
/// estimate are 0 if and only if the two touch. Preconditions: as exact_distance().
Bracket narrow_distance(const Segment& segment, const Triangle& triangle);

}  // namespace keepout::oracle
