// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/travel.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

namespace keepout::monitor {
namespace {

// Fewer than a hundred roundings of positive numbers.
constexpr double rounding = 1.0 + 1e-13;

double lever(const JointLine& joint, const Vec3& point) noexcept {
  return joint.axis.cross(point - joint.origin).norm();
}

}  // namespace

JointLine joint_line(const TableRow& row, const LinkFrame& link, double change) noexcept {
  return {row.slides, std::abs(change), link.origin.cast<double>(),
          (link.axes * row.axis.cast<LinkFrame::Real>()).cast<double>()};
}

Travel travel(std::span<const JointLine> start, std::span<const JointLine> end, const Vec3& from,
              const Vec3& to) noexcept {
  Travel all;
  for (std::size_t k = start.size(); k-- > 0;) {
    const double change = start[k].change;
    if (change == 0.0) continue;
    if (start[k].slides) {
      all.speed += change;
      continue;
    }
    const double turn = change * 0.5 * (lever(start[k], from) + lever(end[k], to) + all.speed);
    all.bend += change * (2.0 * all.speed + turn);
    all.speed += turn;
  }
  return {all.speed * rounding, all.bend * rounding};
}

double least_between(double a, double b, double bend) noexcept {
  const double half = 0.5 * bend;
  const double rise = b - a;
  if (rise >= half) return a;
  if (-rise >= half) return b;
  const double u = 0.5 * (1.0 - rise / half);  // where the derivative is 0
  return a - half * u * u;
}

}  // namespace keepout::monitor
