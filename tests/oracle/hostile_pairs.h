// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "hostile_triangle.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

struct HostilePair {
  Segment segment;
  Triangle triangle;
};

/// Returns a point on the face, an edge or a corner of the triangle, rounded to doubles.
inline Vec3 place_on(const Triangle& t, Random& random) {
  double b = random.uniform(), c = random.uniform();
  if (b + c > 1.0) {
    b = 1.0 - b;
    c = 1.0 - c;
  }
  const auto corner = random.below(3);
  switch (random.below(3)) {
    case 0:
      return t[0] + b * (t[1] - t[0]) + c * (t[2] - t[0]);
    case 1:
      return t[corner] + b * (t[(corner + 1) % 3] - t[corner]);
    default:
      return t[corner];
  }
}

/// Returns a segment near the triangle. It ends on the triangle, grazes or pierces it, is parallel
/// to an edge or to the face, is a point, or is arbitrary.
inline Segment hostile_segment(const Triangle& t, Random& random) {
  const double near = std::pow(10.0, random.uniform(-16.0, 0.5));
  const Vec3 place = place_on(t, random) + (random.below(4) == 0 ? 0.0 : near) * random.direction();
  const double length = std::pow(10.0, random.uniform(-6.0, 1.0));
  const Vec3 side = t[1] - t[0];
  switch (random.below(7)) {
    case 0:
      return {place, place};
    case 1:
      return {place, place + length * random.direction()};
    case 2: {
      const Vec3 way = length * random.direction();
      return {place - random.uniform() * way, place + random.uniform() * way};
    }
    case 3:
      return {place, place + length * side};
    case 4:
      return {place, place_on(t, random)};
    case 5:
      return {place, place + length * (place_on(t, random) - place)};
    default:
      return {place, place_on(t, random) + near * random.direction()};
  }
}

/// Returns a hostile triangle and segment, scaled by 1e-6 to 1e6. Sometimes they are 1e4 to 1e6 of
/// these units from the origin.
inline HostilePair hostile_pair(Random& random) {
  HostilePair pair;
  pair.triangle = test::hostile_triangle(random);
  pair.segment = hostile_segment(pair.triangle, random);
  if (random.below(2) == 0) std::swap(pair.segment.from, pair.segment.to);
  const double scale = std::pow(10.0, random.uniform(-6.0, 6.0));
  const Vec3 offset = random.below(3) == 0
                          ? Vec3(std::pow(10.0, random.uniform(4.0, 6.0)) * random.direction())
                          : Vec3(Vec3::Zero());
  for (Vec3* v : {&pair.triangle[0], &pair.triangle[1], &pair.triangle[2], &pair.segment.from,
                  &pair.segment.to}) {
    *v = scale * (*v + offset);
  }
  return pair;
}

}  // namespace keepout::oracle
