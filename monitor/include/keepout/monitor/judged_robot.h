// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/monitor/distance.h"

namespace keepout::monitor {

/// A row of a Denavit-Hartenberg table in Craig's convention: a rotation about x, a displacement
/// along x, a rotation about z, a displacement along z. The joint turns about z or slides along z.
/// The frame after the row is that of its link.
///
/// A row of a robot that has no table has the fixed transform `before` instead, and its joint turns
/// about `axis` or slides along it.
struct TableRow {
  bool slides = false;        // the position is added to d, and not to theta
  double a = 0.0;             // along x [length]
  double alpha_quarters = 0;  // about x, in right angles
  double d = 0.0;             // along z [length]
  double theta_quarters = 0;  // about z, in right angles
  Pose before = {};           // precedes all of this
  Vec3 axis = Vec3::UnitZ();  // of the joint, unit
};

/// A point that a link carries.
struct JudgedPoint {
  int link = 0;                  // 0 is the base
  Vec3 position = Vec3::Zero();  // in the frame of the link [length]
};

/// A body that must stay clear: all points within `radius` of the convex hull of 1 to 8 points.
/// Three points or more must be on one link.
struct JudgedBody {
  std::vector<JudgedPoint> points;
  double radius = 0.0;  // [length]
};

/// A robot in the judge's own data types.
struct JudgedRobot {
  std::vector<TableRow> table;
  std::vector<JudgedBody> bodies;
};

/// Returns the manipulator of the da Vinci Research Kit with an 8 mm instrument, from its published
/// tables. [mm]
JudgedRobot judged_psm();
/// Returns a KUKA LBR iiwa 7 with a straight shaft and a cutter. [mm]
JudgedRobot judged_seven_joint_arm();

/// The pose of a link, in the frame in which the base was given.
struct LinkFrame {
  using Real = long double;

  Eigen::Matrix<Real, 3, 3> axes;
  Eigen::Matrix<Real, 3, 1> origin;  // [length]

  Vec3 at(const Vec3& point) const {
    return (origin + axes * point.cast<Real>()).template cast<double>();
  }
};

/// Returns the frames of the links, the base first, computed in long double. `base`: the pose of
/// link 0. Precondition: one position for each row [rad or length].
std::vector<LinkFrame> place(const JudgedRobot& robot, const Pose& base,
                             std::span<const double> positions);
/// Like place(robot, base, positions), but writes to `links`, one more than rows. Does not
/// allocate.
void place(const JudgedRobot& robot, const Pose& base, std::span<const double> positions,
           std::span<LinkFrame> links) noexcept;

/// Returns the segment from a body's first point to its last one.
Segment axis_of(const JudgedBody& body, std::span<const LinkFrame> links);

}  // namespace keepout::monitor
