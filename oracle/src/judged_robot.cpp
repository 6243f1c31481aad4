// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/judged_robot.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace keepout::oracle {
namespace {

using Real = long double;

/// Where a link is: from its frame to that of the mesh.
struct Frame {
  Eigen::Matrix<Real, 3, 3> axes;
  Eigen::Matrix<Real, 3, 1> origin;

  /// About one of its own axes, and along it.
  void screw(int axis, Real angle, Real way) {
    origin += way * axes.col(axis);
    if (angle == 0) return;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    const Eigen::Matrix<Real, 3, 1> before = axes.col(u);
    axes.col(u) = std::cos(angle) * before + std::sin(angle) * axes.col(v);
    axes.col(v) = std::cos(angle) * axes.col(v) - std::sin(angle) * before;
  }
};

}  // namespace

void place(const JudgedRobot& robot, const Pose& base, std::span<const double> positions,
           std::span<Segment> axes) {
  constexpr Real right_angle = std::numbers::pi_v<Real> / 2;
  Frame link{base.rotation.cast<Real>(), base.position.cast<Real>()};
  for (std::size_t k = 0;; ++k) {
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
      for (const std::size_t end : {0, 1}) {
        const auto& [of, position] = robot.bodies[b].ends[end];
        if (of != static_cast<int>(k)) continue;
        (end == 0 ? axes[b].from : axes[b].to) =
            (link.origin + link.axes * position.cast<Real>()).cast<double>();
      }
    }
    if (k == robot.table.size()) return;
    const TableRow& row = robot.table[k];
    const Real q = positions[k];
    link.screw(0, row.alpha_quarters * right_angle, row.a);
    link.screw(2, row.theta_quarters * right_angle + (row.slides ? 0 : q),
               row.d + (row.slides ? q : 0));
  }
}

JudgedRobot judged_psm() {
  return {.table = {{.alpha_quarters = 1, .theta_quarters = 1},
                    {.alpha_quarters = -1, .theta_quarters = -1},
                    {.slides = true, .alpha_quarters = 1, .d = -431.8},
                    {.d = 416.2},
                    {.alpha_quarters = -1, .theta_quarters = -1},
                    {.a = 9.1, .alpha_quarters = -1, .theta_quarters = -1}},
          .bodies = {
              {{{{0}, {5}}}, 4.5}, {{{{5}, {6}}}, 3.0}, {{{{6}, {6, Vec3(0.0, 10.2, 0.0)}}}, 1.0}}};
}

JudgedRobot judged_seven_joint_arm() {
  const JudgedBody::End wrist{5};
  const JudgedBody::End shaft_end{7, Vec3(0.0, 0.0, 300.0)};
  return {.table = {{.d = 340.0},
                    {.alpha_quarters = -1},
                    {.alpha_quarters = 1, .d = 400.0},
                    {.alpha_quarters = 1},
                    {.alpha_quarters = -1, .d = 400.0},
                    {.alpha_quarters = -1},
                    {.alpha_quarters = 1, .d = 126.0}},
          .bodies = {{{{{4}, wrist}}, 65.0},
                     {{{wrist, {7, Vec3(0.0, 0.0, -45.0)}}}, 45.0},
                     {{{{7}, shaft_end}}, 4.5},
                     {{{shaft_end, {7, Vec3(0.0, 0.0, 308.0)}}}, 2.0}}};
}

}  // namespace keepout::oracle
