// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/fixtures/random.h"
#include "keepout/oracle/judged_robot.h"
#include "verify/robot/start.h"

namespace keepout::app {

/// A chain of 3 to 7 joints, of any twists and offsets up to 60 mm, with one to three bodies:
/// balls, capsules and blades, some of radius 0.
RobotUnderTest drawn_robot(Random& random);

/// Three joints that slide along orthogonal axes, and the tool: a ball, or the hull of up to 8
/// points.
RobotUnderTest sliding_ball(Random& random);
RobotUnderTest sliding_hull(Random& random);

/// Four sliding joints. The last three carry the tool, which can give way in every direction. The
/// first carries a body, and stands at its upper limit when a mesh comes on along its axis; one
/// more body is on the base.
RobotUnderTest robot_with_stuck_bodies(Random& random);

/// Returns a copy of the robot with a blade of 3 to 8 points on its last link, as the last body.
RobotUnderTest with_blade(const RobotUnderTest& robot, Random& random);

/// Returns a copy of the robot without velocity limits.
RobotUnderTest without_velocity_limits(const RobotUnderTest& robot);

}  // namespace keepout::app
