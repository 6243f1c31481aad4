// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "keepout/monitor/judged_robot.h"
#include "keepout/monitor/motion_check.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// A guide in the judge's own data types: a guided part of a robot, and the convex region in which
/// the part must stay.
struct JudgedGuide {
  enum class Kind : std::uint8_t {
    point,         // `first` stays in the region
    axis,          // the direction `first.position` of a link; the region is a ball about a unit
                   // vector, whose radius is the chord of an angle
    remote_center  // the point of the segment from `first` to `second` that is nearest to the
                   // origin of the region, which is a ball
  };
  enum class Region : std::uint8_t { half_space, slab, tube, ball };

  Kind kind = Kind::point;
  JudgedPoint first = {};
  JudgedPoint second = {};
  Region region = Region::ball;
  Vec3 origin = Vec3::Zero();      // [length]
  Vec3 direction = Vec3::UnitZ();  // unit: into a half-space, normal of a slab, along a tube
  double radius = 0.0;             // of a slab half the width; of a half-space 0 [length]
  double band = 0.0;               // the excess that is allowed [length, or chord]
};

/// Returns the distance of the guided point from its region, computed in long double; below 0
/// inside. `links`: those of the robot, in the frame of the region. [length, or chord]
double excess(const JudgedGuide& guide, std::span<const LinkFrame> links);

/// Decides if the excess of a guide is at most `most` on the whole motion of the joints, with
/// nothing left out between poses.
///
/// The excess is a convex function of the guided point, and changes by no more than this point
/// moves. So the bounds of MotionCheck hold for it, with its sign reversed. The guided point of a
/// remote center moves along the segment too. Let its fraction of the segment change by v in a part
/// of the motion of the length w. The point whose fraction changes linearly has the second
/// derivative M + 2 v / w (P of the first end + P of the second). It is no nearer to the origin.
MotionFinding check_guide(const JudgedGuide& guide, const JudgedRobot& robot, const Pose& base,
                          const InstrumentMotion& motion, double most);

}  // namespace keepout::oracle
