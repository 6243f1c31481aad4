// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout::monitor {

/// A closed segment; its two ends may coincide. [length]
struct Segment {
  Vec3 from;
  Vec3 to;
};

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
  Vec3 direction;  // of any length; 0 if unknown
};

/// Like bracket_distance(), but also returns the direction.
Gap gap_between(const Segment& segment, const Triangle& triangle) noexcept;

/// A function that brackets the distance between a segment and a triangle: bracket_distance(), or
/// an exact one.
using BracketFunction = Bracket (*)(const Segment&, const Triangle&);

}  // namespace keepout::monitor
