// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// A row of a table after Denavit and Hartenberg as Craig has it: about x, along x, about z, along
/// z. A joint turns or moves along z, and the frame behind the row is its link's.
struct TableRow {
  bool slides = false;        // the position is added to d, and not to theta
  double a = 0.0;             // along x [length]
  double alpha_quarters = 0;  // about x, in right angles
  double d = 0.0;             // along z [length]
  double theta_quarters = 0;  // about z, in right angles
};

/// A point that a link carries.
struct JudgedPoint {
  int link = 0;                  // 0 is the base
  Vec3 position = Vec3::Zero();  // in the frame of the link [length]
};

/// A body that keeps clear: all within `radius` of the convex hull of its points, 1 to 8. Three
/// points or more are on one link.
struct JudgedBody {
  std::vector<JudgedPoint> points;
  double radius = 0.0;  // [length]
};

/// A robot told once more, in numbers of the judge's own.
struct JudgedRobot {
  std::vector<TableRow> table;
  std::vector<JudgedBody> bodies;
};

/// The da Vinci research kit's manipulator with an 8 mm instrument, as its tables have it. [mm]
JudgedRobot judged_psm();
/// KUKA LBR iiwa 7 with a straight shaft and a cutter. [mm]
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

/// Returns the frames of the links, the base first, in long double from link to link. `base`: the
/// pose of link 0. Precondition: a position for each row [rad or length].
std::vector<LinkFrame> place(const JudgedRobot& robot, const Pose& base,
                             std::span<const double> positions);

/// Returns the segment from a body's first point to its last one.
Segment axis_of(const JudgedBody& body, std::span<const LinkFrame> links);

}  // namespace keepout::oracle
