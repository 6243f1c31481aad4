// SPDX-License-Identifier: BSD-3-Clause
#include "guide_kinematics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "keepout/robot/motion_bounds.h"

namespace keepout {

Vec3 guided_point(const Guide& guide, const ChainState& state) noexcept {
  // A difference of two positions would have a rounding error that grows with the distance from the
  // origin.
  if (guide.kind() == Guide::Kind::axis)
    return state.link(guide.first().link).rotation * guide.first().position;
  const Vec3 from = state.at(guide.first().link, guide.first().position);
  if (guide.kind() == Guide::Kind::point) return from;
  return from + guided_fraction(guide, state) *
                    (state.at(guide.second().link, guide.second().position) - from);
}

double guided_fraction(const Guide& guide, const ChainState& state) noexcept {
  if (guide.kind() != Guide::Kind::shaft) return 0.0;
  const Vec3 from = state.at(guide.first().link, guide.first().position);
  const Vec3 along = state.at(guide.second().link, guide.second().position) - from;
  const double length2 = along.squaredNorm();
  return length2 > 0.0 ? std::clamp(along.dot(guide.region().origin() - from) / length2, 0.0, 1.0)
                       : 0.0;
}

Vec3 guided_derivative(const Guide& guide, const ChainState& state, int k) noexcept {
  if (guide.kind() == Guide::Kind::axis)
    return state.angular(k, guide.first().link).cross(guided_point(guide, state));
  const Vec3 from =
      state.linear(k, guide.first().link, state.at(guide.first().link, guide.first().position));
  if (guide.kind() == Guide::Kind::point) return from;
  const Vec3 to =
      state.linear(k, guide.second().link, state.at(guide.second().link, guide.second().position));
  return from + guided_fraction(guide, state) * (to - from);
}

double guided_bend(const Guide& guide, const ChainState& state, std::span<const double> increment,
                   double slide) noexcept {
  if (guide.kind() == Guide::Kind::axis) {
    // Like motion_bounds, but only rotations matter.
    const Vec3 direction = guided_point(guide, state);
    MotionBounds bounds;
    for (int k = guide.first().link; k >= 1; --k) {
      if (!state.turns(k)) continue;
      bounds.turn(state.axis(k).cross(direction).norm(),
                  std::abs(increment[static_cast<std::size_t>(k - 1)]));
    }
    return bounds.bend;
  }
  const auto of = [&](const LinkPoint& point) {
    return motion_bounds(state, increment, point.link, state.at(point.link, point.position));
  };
  const MotionBounds first = of(guide.first());
  if (guide.kind() == Guide::Kind::point) return first.bend;
  // Bounds another point of the shaft, p = (1 - u) a + u b, with u linear between the fractions of
  // the guided point at both ends. It is never nearer to the center than the guided point
  // (docs/guides.md). Its second derivative is (1 - u) a'' + u b'' + 2 u' (b' - a').
  const MotionBounds second = of(guide.second());
  return std::max(first.bend, second.bend) + 2.0 * slide * (first.path + second.path);
}

}  // namespace keepout
