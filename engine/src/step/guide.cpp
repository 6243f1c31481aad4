// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/guide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

constexpr double usual_band = 0.002;           // [length], as InstrumentOptions::band
constexpr double most_angle = 3.0;             // beyond it chords hardly grow with the angle [rad]
constexpr double usual_angular_band = 0.0002;  // [rad]

Vec3 unit(const Vec3& direction, const std::string& name) {
  const double length = direction.norm();
  if (!(length > shortest_length && length < longest_length)) {
    throw Error("guide '" + name + "' has a direction of length zero, or one that is not finite");
  }
  return direction / length;
}

/// Returns the chord of an angle on the unit sphere.
double chord(double angle, const std::string& name) {
  if (!(angle > 0.0 && angle <= most_angle)) {
    throw Error("guide '" + name +
                "' has an angle that is not above 0 and at most 3 rad: " + text_of(angle));
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
    if (point.link < 0) {
      throw Error("guide '" + name_ + "' is on link " + std::to_string(point.link) +
                  ", which no chain has");
    }
    if (!(point.position.norm() <= longest_length)) {
      throw Error("guide '" + name_ + "' has a point that is not finite, or too far away");
    }
  }
}

Guide Guide::point(std::string name, const Region& region) {
  return point(std::move(name), LinkPoint{}, region);
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
  if (!(tolerance >= shortest_length && tolerance <= longest_length)) {
    throw Error("guide '" + name + "' has a tolerance of " + text_of(tolerance) +
                ", and needs a number from 1e-15 to 1e15");
  }
  return {Kind::shaft, std::move(name), from, to, Region::ball(center, tolerance)};
}

std::vector<Guide> Guide::orientation(const std::string& name, int link, const Mat3& rotation,
                                      double angle) {
  if (!(((rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff()) < 1e-9)) {
    throw Error("guide '" + name + "' has an orientation that is not a rotation matrix");
  }
  // The squares of the chords of three axes add up to 8 sin^2(angle / 2), where `angle` is the
  // angle of the rotation. So if each squared chord is at most a third of that, the rotation is
  // within `angle`.
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
    throw Error("the band of guide '" + name_ + "' must be a length above 0, got " + text_of(band));
  }
  Guide guide = *this;
  guide.band_ = band;
  return guide;
}

int Guide::link() const noexcept { return std::max(first_.link, second_.link); }

std::string_view name(Relaxation relaxation) noexcept {
  constexpr std::array<std::string_view, 3> names{"none", "guides", "recovery"};
  const auto place = static_cast<std::size_t>(relaxation);
  return place < names.size() ? names[place] : "unknown";
}

}  // namespace keepout
