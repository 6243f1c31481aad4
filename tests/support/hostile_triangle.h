// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/shapes.h"

namespace keepout::test {

/// Returns a triangle of size about 1, from well-shaped to degenerate: needles and caps with
/// heights down to 1e-18, collinear corners, segments, points.
inline Triangle hostile_triangle(Random& random) {
  const auto point = [&]() -> Vec3 { return random.direction() * random.uniform(); };
  Triangle t{point(), point(), point()};
  const double tiny = std::pow(10.0, random.uniform(-18.0, 0.0));
  switch (random.below(8)) {
    case 0:  // needle: two corners close together
      t[2] = t[1] + tiny * point();
      break;
    case 1:  // cap: the third corner next to the opposite side
      t[2] = t[0] + random.uniform() * (t[1] - t[0]) + tiny * point();
      break;
    case 2:  // collinear, the third corner beyond the second
      t[2] = t[0] + 2.0 * (t[1] - t[0]);
      break;
    case 3:  // a segment
      t[random.below(3)] = t[random.below(3)];
      break;
    case 4:  // a point
      t[1] = t[2] = t[0];
      break;
    default:
      break;
  }
  std::swap(t[random.below(3)], t[random.below(3)]);
  return t;
}

}  // namespace keepout::test
