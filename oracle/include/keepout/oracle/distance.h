// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>

#include "keepout/geometry/shapes.h"

namespace keepout::oracle {

/// A closed segment; its two ends may coincide. [length]
struct Segment {
  Vec3 from;
  Vec3 to;
};

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

/// Bounds of a distance, computed in double arithmetic: low <= the exact distance <= high. [length]
struct Bracket {
  double low;       // >= 0
  double estimate;  // from low to high
  double high;

  /// Returns true if high - low is at most a billionth of the estimate.
  bool narrow() const noexcept { return high - low <= 1e-9 * estimate; }
};

/// Brackets the distance between a segment and a triangle, which may be degenerate. Takes about
/// 100 ns.
///
/// The width is proved for each pair after the computation, so needles and nearly parallel features
/// need no case analysis. The size S is the largest 1-norm of corner - from and to - from.
///
/// - `high`: the distance of a point of the segment and a point of the triangle. No two such points
///   are nearer than segment and triangle. The distance has an error of a few roundings of S, even
///   if they are not the nearest points.
///
/// - `low`: let h be the least n . x over the segment minus the largest over the triangle. Then the
/// sets are at least h / |n| apart, for any direction n. The error is again a few roundings of S.
///
/// Both errors are below 2^-48 S (bracket_distance.cpp derives this bound). The estimate is the
/// distance of the two points. If these points and n are accurate, as nearly always, the bracket is
/// about 2^-47 S wide. It is wider if the sets almost touch, or if S is outside 1e-70 .. 1e70: then
/// exact_distance() must decide.
Bracket bracket_distance(const Segment& segment, const Triangle& triangle) noexcept;

/// A bracket, and the direction from the triangle to the other set along which they are about
/// `estimate` apart.
struct Gap {
  Bracket distance;
  Vec3 direction;  // of any length; 0 if there is none
};

/// Like bracket_distance(), but also returns the direction.
Gap gap_between(const Segment& segment, const Triangle& triangle) noexcept;

/// Like bracket_distance(), but always narrow: calls exact_distance() if double arithmetic does not
/// suffice. low and estimate are 0 if and only if the two touch. Preconditions: as
/// exact_distance().
Bracket narrow_distance(const Segment& segment, const Triangle& triangle);

}  // namespace keepout::oracle
