// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "keepout/fixtures/random.h"
#include "verify/robot/campaign.h"
#include "verify/robot/robot_setup.h"

namespace keepout::app {

/// A row of a campaign in the making.
struct RobotRow {
  const RobotCampaign& campaign;
  const Scenario& scenario;
  std::function<JudgedMesh(Random&)> draw_mesh;
  bool is_drawn;                // the mesh, or the robot
  const RobotUnderTest* robot;  // null: drawn
  RobotTally tally;
  std::vector<double> times = {};        // [us]
  std::vector<double> point_times = {};  // [us]
};

/// Runs an instrument from a start for at most `cycles` cycles, judges each, and adds them to the
/// row. Ends early if no motion can be proved for 50 cycles.
void run_attempt(RobotRow& row, RobotSetup setup, Random& random, std::uint64_t cycles);

}  // namespace keepout::app
