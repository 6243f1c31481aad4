// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/judged_robot.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace keepout::monitor {
namespace {

using Real = LinkFrame::Real;

/// Rotates a frame about one of its own axes, and moves it along that axis.
void screw(LinkFrame& frame, int axis, Real angle, Real way) {
  frame.origin += way * frame.axes.col(axis);
  if (angle == 0) return;
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const Real cosine = std::cos(angle);
  const Real sine = std::sin(angle);
  const Eigen::Matrix<Real, 3, 1> before = frame.axes.col(u);
  frame.axes.col(u) = cosine * before + sine * frame.axes.col(v);
  frame.axes.col(v) = cosine * frame.axes.col(v) - sine * before;
}

/// Rotates a frame about an axis, which is given in this frame, and moves it along that axis.
/// Source: Rodrigues' formula.
void screw(LinkFrame& frame, const Vec3& axis, Real angle, Real way) {
  const Eigen::Matrix<Real, 3, 1> unit = axis.cast<Real>();
  frame.origin += way * (frame.axes * unit);
  if (angle == 0) return;
  Eigen::Matrix<Real, 3, 3> across;
  across << 0, -unit.z(), unit.y(), unit.z(), 0, -unit.x(), -unit.y(), unit.x(), 0;
  const Eigen::Matrix<Real, 3, 3> turn = Eigen::Matrix<Real, 3, 3>::Identity() +
                                         std::sin(angle) * across +
                                         (1 - std::cos(angle)) * across * across;
  frame.axes = (frame.axes * turn).eval();
}

}  // namespace

std::vector<LinkFrame> place(const JudgedRobot& robot, const Pose& base,
                             std::span<const double> positions) {
  std::vector<LinkFrame> links(robot.table.size() + 1);
  place(robot, base, positions, links);
  return links;
}

void place(const JudgedRobot& robot, const Pose& base, std::span<const double> positions,
           std::span<LinkFrame> links) noexcept {
  constexpr Real right_angle = std::numbers::pi_v<Real> / 2;
  links[0] = {base.rotation.cast<Real>(), base.position.cast<Real>()};
  for (std::size_t k = 0; k < robot.table.size(); ++k) {
    const TableRow& row = robot.table[k];
    const Real q = positions[k];
    LinkFrame& link = links[k + 1];
    link = links[k];
    link.origin += link.axes * row.before.position.cast<Real>();
    link.axes = (link.axes * row.before.rotation.cast<Real>()).eval();
    screw(link, 0, row.alpha_quarters * right_angle, row.a);
    if (row.axis == Vec3::UnitZ()) {
      screw(link, 2, row.theta_quarters * right_angle + (row.slides ? 0 : q),
            row.d + (row.slides ? q : 0));
    } else {
      screw(link, 2, row.theta_quarters * right_angle, row.d);
      screw(link, row.axis, row.slides ? 0 : q, row.slides ? q : 0);
    }
  }
}

Segment axis_of(const JudgedBody& body, std::span<const LinkFrame> links) {
  const auto at = [&](const JudgedPoint& point) {
    return links[static_cast<std::size_t>(point.link)].at(point.position);
  };
  return {at(body.points.front()), at(body.points.back())};
}

JudgedRobot judged_psm() {
  return {
      .table = {{.alpha_quarters = 1, .theta_quarters = 1},
                {.alpha_quarters = -1, .theta_quarters = -1},
                {.slides = true, .alpha_quarters = 1, .d = -431.8},
                {.d = 416.2},
                {.alpha_quarters = -1, .theta_quarters = -1},
                {.a = 9.1, .alpha_quarters = -1, .theta_quarters = -1}},
      .bodies = {{{{0}, {5}}, 4.5}, {{{5}, {6}}, 3.0}, {{{6}, {6, Vec3(0.0, 10.2, 0.0)}}, 1.0}}};
}

JudgedRobot judged_seven_joint_arm() {
  const JudgedPoint wrist{5};
  const JudgedPoint shaft_end{7, Vec3(0.0, 0.0, 300.0)};
  return {.table = {{.d = 340.0},
                    {.alpha_quarters = -1},
                    {.alpha_quarters = 1, .d = 400.0},
                    {.alpha_quarters = 1},
                    {.alpha_quarters = -1, .d = 400.0},
                    {.alpha_quarters = -1},
                    {.alpha_quarters = 1, .d = 126.0}},
          .bodies = {{{{4}, wrist}, 65.0},
                     {{wrist, {7, Vec3(0.0, 0.0, -45.0)}}, 45.0},
                     {{{7}, shaft_end}, 4.5},
                     {{shaft_end, {7, Vec3(0.0, 0.0, 308.0)}}, 2.0}}};
}

}  // namespace keepout::monitor
