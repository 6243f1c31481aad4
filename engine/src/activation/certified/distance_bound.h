// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/facet.h"

namespace keepout {

/// Returns v at unit length; zero if it has no direction.
inline Vec3 unit(const Vec3& v) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3::Zero();
}

/// A lower bound of the distance along a motion z, less a level: `at_0` + t `slope`.
struct Line {
  double at_0;
  double slope;

  double at(double t) const noexcept { return at_0 + t * slope; }
};

inline Line line_of(const Facet::Nearest& nearest, const Vec3& z, double level) noexcept {
  return {-nearest.support - level, nearest.normal.dot(z)};
}

inline bool holds(const Line& line, double slack) noexcept {
  return line.at_0 >= -slack && line.at(1.0) >= -slack;
}

}  // namespace keepout
