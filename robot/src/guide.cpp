// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/guide.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/error.h"
#include "keepout/robot/motion_bounds.h"

namespace keepout {
namespace {

constexpr double usual_band = 0.002;           // [length], as InstrumentOptions::band
constexpr double most_angle = 3.0;             // where chords still tell angles apart [rad]
constexpr double usual_angular_band = 0.0002;  // [rad]

Vec3 unit(const Vec3& direction, const std::string& name) {
  const double length = direction.norm();
  if (!(length > shortest_length && length < longest_length)) {
    throw Error("guide '" + name + "' has a direction that has no length, or is not finite");
  }
  return direction / length;
}

/// The chord of an angle on the unit sphere.
double chord(double angle, const std::string& name) {
  if (!(angle > 0.0 && angle <= most_angle)) {
    throw Error("guide '" + name + "' has an angle that is not above 0 and at most 3 rad");
  }
  return 2.0 * std::sin(0.5 * angle);
}

}  // namespace

Guide::Guide(Kind kind, std::string name, const LinkPoint& first, const LinkPoint& second,
             const Region& region)
    : kind_(kind),
      name_(std::move(name)),
      first_(first),
      second_(second),
      region_(region),
      band_(kind == Kind::axis ? usual_angular_band : usual_band) {
  for (const LinkPoint& point : {first_, second_}) {
    if (point.link < 0 || point.link > Chain::most_joints) {
      throw Error("guide '" + name_ + "' is on link " + std::to_string(point.link) +
                  ", which no chain has");
    }
    if (!(point.position.norm() <= longest_length)) {
      throw Error("guide '" + name_ + "' has a point that is not finite, or too far away");
    }
  }
}

Guide Guide::point(std::string name, const LinkPoint& point, const Region& region) {
  return {Kind::point, std::move(name), point, point, region};
}

Guide Guide::axis(std::string name, int link, const Vec3& axis, const Vec3& direction,
                  double angle) {
  const Vec3 of_link = unit(axis, name);
  const Region region = Region::ball(unit(direction, name), chord(angle, name));
  return {Kind::axis, std::move(name), {link, of_link}, {link, of_link}, region};
}

Guide Guide::remote_center(std::string name, const LinkPoint& from, const LinkPoint& to,
                           const Vec3& center, double tolerance) {
  return {Kind::shaft, std::move(name), from, to, Region::ball(center, tolerance)};
}

std::vector<Guide> Guide::orientation(const std::string& name, int link, const Mat3& rotation,
                                      double angle) {
  if (!(((rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff()) < 1e-9)) {
    throw Error("guide '" + name + "' is to keep an orientation that is no rotation");
  }
  // The squares of the chords of three axes add up to 8 sin^2(angle / 2) of the turn: so if none is
  // more than a third of that, the turn is not more.
  const double each = std::sqrt(8.0 / 3.0) * 0.5 * chord(angle, name);
  std::vector<Guide> guides;
  for (int axis = 0; axis < 3; ++axis) {
    guides.push_back(Guide::axis(name + " " + "xyz"[axis], link, Vec3::Unit(axis),
                                 rotation.col(axis), 2.0 * std::asin(std::min(0.5 * each, 1.0))));
  }
  return guides;
}

Guide Guide::with_band(double band) const {
  if (!(band >= shortest_length && band <= longest_length)) {
    throw Error("the band of guide '" + name_ + "' must be above zero");
  }
  Guide guide = *this;
  guide.band_ = band;
  return guide;
}

int Guide::link() const noexcept { return std::max(first_.link, second_.link); }

Vec3 Guide::place(const ChainState& state) const noexcept {
  if (kind_ == Kind::axis)
    return state.at(first_.link, first_.position) - state.at(first_.link, Vec3::Zero());
  const Vec3 from = state.at(first_.link, first_.position);
  if (kind_ == Kind::point) return from;
  return from + share(state) * (state.at(second_.link, second_.position) - from);
}

double Guide::share(const ChainState& state) const noexcept {
  if (kind_ != Kind::shaft) return 0.0;
  const Vec3 from = state.at(first_.link, first_.position);
  const Vec3 along = state.at(second_.link, second_.position) - from;
  const double length2 = along.squaredNorm();
  return length2 > 0.0 ? std::clamp(along.dot(region_.origin() - from) / length2, 0.0, 1.0) : 0.0;
}

Vec3 Guide::derivative(const ChainState& state, int k) const noexcept {
  if (kind_ == Kind::axis) return state.angular(k, first_.link).cross(place(state));
  const Vec3 from = state.linear(k, first_.link, state.at(first_.link, first_.position));
  if (kind_ == Kind::point) return from;
  const Vec3 to = state.linear(k, second_.link, state.at(second_.link, second_.position));
  return from + share(state) * (to - from);
}

double Guide::bend(const ChainState& state, std::span<const double> increment,
                   double slide) const noexcept {
  if (kind_ == Kind::axis) {
    // As motion_bounds, of which only what turns is left.
    const Vec3 direction = place(state);
    double path = 0.0;
    double bend = 0.0;
    for (int k = first_.link; k >= 1; --k) {
      if (!state.turns(k)) continue;
      const double turn = std::abs(increment[static_cast<std::size_t>(k - 1)]);
      const double way = turn * (state.axis(k).cross(direction).norm() + path);
      bend += turn * (way + 2.0 * path);
      path += way;
    }
    return bend;
  }
  const auto of = [&](const LinkPoint& point) {
    return motion_bounds(state, increment, point.link, state.at(point.link, point.position));
  };
  const MotionBounds first = of(first_);
  if (kind_ == Kind::point) return first.bend;
  // p = (1 - u) a + u b, u linear: p'' = (1 - u) a'' + u b'' + 2 u' (b' - a').
  const MotionBounds second = of(second_);
  return std::max(first.bend, second.bend) + 2.0 * slide * (first.path + second.path);
}

}  // namespace keepout
