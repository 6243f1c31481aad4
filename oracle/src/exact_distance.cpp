// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "integer_frame.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {
namespace {

/// A rational number >= 0. It is not reduced, because that would cost more than the comparisons.
/// The denominator is > 0.
struct Fraction {
  Integer numerator;
  Integer denominator;
};

bool operator<(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

void keep_smaller(Fraction& best, Fraction other) {
  if (other < best) best = std::move(other);
}

Fraction squared_length(const IntegerVec& v) { return {dot(v, v), 1}; }

/// Returns the squared distance of `point` from the segment from `start` to `start` + `way`.
Fraction to_segment(const IntegerVec& point, const IntegerVec& start, const IntegerVec& way) {
  const IntegerVec offset = point - start;
  const Integer along = dot(offset, way);
  if (along <= 0) return squared_length(offset);
  Integer way2 = dot(way, way);
  if (along >= way2) return squared_length(offset - way);
  const IntegerVec moment = cross(offset, way);
  return {dot(moment, moment), std::move(way2)};
}

/// Returns the squared distance of the segment from the origin along `way`, from the edge along
/// `side`. It is convex in the two parameters. The least value is where both derivatives vanish, if
/// that is within both segments, otherwise at one of the four ends.
Fraction to_edge(const IntegerVec& way, const IntegerVec& corner, const IntegerVec& side) {
  const IntegerVec common = cross(way, side);
  Integer common2 = dot(common, common);
  if (common2 > 0) {
    const Integer on_way = dot(cross(corner, side), common);
    const Integer on_side = dot(cross(corner, way), common);
    if (on_way >= 0 && on_way <= common2 && on_side >= 0 && on_side <= common2) {
      const Integer across = dot(corner, common);
      return {across * across, std::move(common2)};
    }
  }
  const IntegerVec origin{0, 0, 0};
  const IntegerVec end{corner[0] + side[0], corner[1] + side[1], corner[2] + side[2]};
  Fraction best = to_segment(origin, corner, side);
  keep_smaller(best, to_segment(way, corner, side));
  keep_smaller(best, to_segment(corner, origin, way));
  keep_smaller(best, to_segment(end, origin, way));
  return best;
}

/// Returns true if the foot of `point` in the triangle's plane is on the triangle.
bool above_face(const IntegerVec& point, const std::array<IntegerVec, 3>& corners,
                const IntegerVec& normal) {
  for (int i = 0; i < 3; ++i) {
    const IntegerVec side = corners[(i + 1) % 3] - corners[i];
    if (dot(normal, cross(side, point - corners[i])) < 0) return false;
  }
  return true;
}

/// Returns true if the line along `way` through the origin meets the triangle. Precondition: the
/// line is not in the triangle's plane.
bool line_meets_face(const IntegerVec& way, const std::array<IntegerVec, 3>& corners) {
  int left = 0, right = 0;
  for (int i = 0; i < 3; ++i) {
    const int turn = sgn(dot(way, cross(corners[i], corners[(i + 1) % 3])));
    left += turn > 0;
    right += turn < 0;
  }
  return left == 0 || right == 0;
}

/// Returns the squared distance of the segment from the origin along `way`, from the triangle. It
/// is attained at an edge of the triangle, or at an end of the segment above the face, or it is
/// zero because the segment pierces the face.
Fraction to_triangle(const IntegerVec& way, const std::array<IntegerVec, 3>& corners) {
  const IntegerVec sides[3]{corners[1] - corners[0], corners[2] - corners[1],
                            corners[0] - corners[2]};
  const IntegerVec normal = cross(sides[0], sides[1]);
  const Integer normal2 = dot(normal, normal);
  const Integer start_height = -dot(normal, corners[0]);
  const Integer end_height = dot(normal, way) + start_height;
  const bool has_area = normal2 > 0;
  if (has_area && sgn(start_height) * sgn(end_height) <= 0 && start_height != end_height &&
      line_meets_face(way, corners)) {
    return {0, 1};
  }
  Fraction best = to_edge(way, corners[0], sides[0]);
  keep_smaller(best, to_edge(way, corners[1], sides[1]));
  keep_smaller(best, to_edge(way, corners[2], sides[2]));
  if (has_area) {
    if (above_face({0, 0, 0}, corners, normal)) {
      keep_smaller(best, {start_height * start_height, normal2});
    }
    if (above_face(way, corners, normal)) keep_smaller(best, {end_height * end_height, normal2});
  }
  return best;
}

/// Returns the root of fraction * 4^exponent, also for numbers far beyond the range of a double. It
/// is at least the smallest double above 0. Precondition: the fraction is > 0.
double root(const Fraction& fraction, int exponent) {
  long numerator_exponent = 0, denominator_exponent = 0;
  const double numerator = mpz_get_d_2exp(&numerator_exponent, fraction.numerator.get_mpz_t());
  const double denominator =
      mpz_get_d_2exp(&denominator_exponent, fraction.denominator.get_mpz_t());
  long power = numerator_exponent - denominator_exponent;
  double ratio = numerator / denominator;
  if (power % 2 != 0) {
    ratio *= 2.0;
    --power;
  }
  return std::max(std::ldexp(std::sqrt(ratio), static_cast<int>(power / 2) + exponent),
                  std::numeric_limits<double>::denorm_min());
}

std::strong_ordering ordering(int sign) { return sign <=> 0; }

}  // namespace

ExactDistance exact_distance(const Segment& segment, const Triangle& triangle, double threshold) {
  IntegerFrame frame;
  frame.include(threshold);
  frame.include(segment.from);
  frame.include(segment.to);
  for (const Vec3& corner : triangle) frame.include(corner);

  const IntegerVec start = frame.integer(segment.from);
  const Fraction squared =
      to_triangle(frame.integer(segment.to) - start,
                  {frame.integer(triangle[0]) - start, frame.integer(triangle[1]) - start,
                   frame.integer(triangle[2]) - start});
  const Integer limit = frame.integer(threshold);
  const Integer squared_limit = limit * limit * squared.denominator;
  return {ordering(sgn(squared.numerator)), ordering(cmp(squared.numerator, squared_limit)),
          squared.numerator == 0 ? 0.0 : root(squared, frame.exponent())};
}

Bracket narrow_distance(const Segment& segment, const Triangle& triangle) {
  const Bracket bracket = bracket_distance(segment, triangle);
  if (bracket.narrow()) return bracket;
  const double distance = exact_distance(segment, triangle, 0.0).distance;
  return {distance * (1.0 - 0x1p-50), distance, distance * (1.0 + 0x1p-50)};
}

}  // namespace keepout::oracle
