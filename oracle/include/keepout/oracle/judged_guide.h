// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "keepout/oracle/judged_robot.h"

namespace keepout::oracle {

/// A guide in the judge's own data types: a guided part of a robot, and the convex region in which
/// the part must stay.
struct JudgedGuide {
  enum class Kind : std::uint8_t {
    point,         // `first` stays in the region
    axis,          // the direction `first.position` of a link; the region is a ball about a unit
                   // vector, whose radius is the chord of an angle
    remote_center  // the point of the segment from `first` to `second` that is nearest to the
                   // region's origin
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

}  // namespace keepout::oracle
