// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// A row of a table after Denavit and Hartenberg as Craig has it: about x, along x, about z, along
/// z. A joint turns or moves along z, and the frame behind the row is its link's.
struct TableRow {
  bool slides = false;     // the position is added to d, and not to theta
  double a = 0.0;          // along x [length]
  int alpha_quarters = 0;  // about x, in right angles
  double d = 0.0;          // along z [length]
  int theta_quarters = 0;  // about z, in right angles
};

/// What keeps clear: all within `radius` of the segment between two points, which may be one.
struct JudgedBody {
  struct End {
    int link = 0;  // 0 is the base
    Vec3 position = Vec3::Zero();
  };
  std::array<End, 2> ends = {};
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

/// Where the axes of the bodies are, in long double from link to link. `base`: where link 0 is.
/// Precondition: a position for each row, and room for an axis of each body.
void place(const JudgedRobot& robot, const Pose& base, std::span<const double> positions,
           std::span<Segment> axes);

}  // namespace keepout::oracle
