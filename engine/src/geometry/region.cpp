// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/region.h"

#include <cmath>
#include <string_view>

#include "direction_of.h"
#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

Vec3 required_direction(const Vec3& given) {
  const Vec3 n = direction_of(given);
  if (n.isZero(0.0)) throw Error("the direction of a region has no length, or is not finite");
  return n;
}

/// Returns a width or a radius. Throws Error, with the name, unless the value is a length above 0.
double length(std::string_view name, double value) {
  OptionText{name, {}, OptionKind::number, "length", positive_length}.accepted(value);
  return value;
}

}  // namespace

Region::Region(Kind kind, const Vec3& origin, const Vec3& direction, const Mat3& across,
               double radius)
    : kind_(kind), origin_(origin), direction_(direction), across_(across), radius_(radius) {
  if (!(origin.cwiseAbs().maxCoeff() <= longest_length)) {
    throw Error("the place of a region is not finite, or too far away");
  }
}

Region Region::half_space(const Vec3& point, const Vec3& into) {
  const Vec3 n = required_direction(into);
  Mat3 across = Mat3::Zero();
  across.row(0) = -n;
  return {Kind::half_space, point, n, across, 0.0};
}

Region Region::slab(const Vec3& point, const Vec3& normal, double half_width) {
  const Vec3 n = required_direction(normal);
  return {Kind::slab, point, n, n * n.transpose(), length("half_width", half_width)};
}

Region Region::tube(const Vec3& point, const Vec3& direction, double radius) {
  const Vec3 d = required_direction(direction);
  return {Kind::tube, point, d, Mat3::Identity() - d * d.transpose(), length("radius", radius)};
}

Region Region::ball(const Vec3& center, double radius) {
  return {Kind::ball, center, Vec3::Zero(), Mat3::Identity(), length("radius", radius)};
}

double Region::excess(const Vec3& point) const noexcept {
  if (kind_ == Kind::half_space) return across_.row(0).dot(point - origin_);
  return (across_ * (point - origin_)).norm() - radius_;
}

Vec3 Region::outward(const Vec3& point) const noexcept {
  if (kind_ == Kind::half_space) return across_.row(0);
  return direction_of(across_ * (point - origin_));
}

}  // namespace keepout
