// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout::trial {

/// Returns the scalar product, summed from the first component to the last, as the loop in Python
/// does. Eigen sums in another order.
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A place relative to a path. [mm]
struct Coordinates {
  double along, across, below;
};

/// The path of experiments/planned_path.py.
struct Path {
  std::vector<Vec3> points, up;
  std::vector<double> order;  // of the points along the heading
  Vec3 across, heading;
  double spacing, length;

  /// Returns the interpolated position at a place along the path, and `up` there. Limited to the
  /// ends.
  std::pair<Vec3, Vec3> at(double along) const {
    const double last = static_cast<double>(points.size()) - 1.0;
    const double place = std::min(std::max(along / spacing, 0.0), last);
    const std::size_t low = std::min(static_cast<std::size_t>(place), points.size() - 2);
    const double share = place - static_cast<double>(low);
    return {(1.0 - share) * points[low] + share * points[low + 1],
            (1.0 - share) * up[low] + share * up[low + 1]};
  }

  /// Returns where a place is. Limited to the ends along the path.
  Coordinates coordinates(const Vec3& place) const {
    const double ahead = dot(place, heading);
    const auto found = std::lower_bound(order.begin(), order.end(), ahead) - order.begin();
    const auto most = static_cast<std::ptrdiff_t>(order.size()) - 2;
    const auto low = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(found - 1, 0, most));
    const double share = (ahead - order[low]) / (order[low + 1] - order[low]);
    const double along =
        std::min(std::max((static_cast<double>(low) + share) * spacing, 0.0), length);
    const auto [point, upwards] = at(along);
    const Vec3 offset = place - point;
    return {along, dot(offset, across), -dot(offset, upwards)};
  }

  Vec3 place(const Coordinates& c) const {
    const auto [point, upwards] = at(c.along);
    return point + c.across * across - c.below * upwards;
  }
};

}  // namespace keepout::trial
