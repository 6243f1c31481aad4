// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulated_robot.h"

#include "keepout/error.h"
#include "keepout/module.h"

namespace keepout::app {

std::unique_ptr<SimulatedRobot> make_simulated_robot(const std::string& robot, double gravity) {
  if (robot != "psm") {
    throw Error("--physics has masses and servos of the robot 'psm' only, not of '" + robot +
                "': leave out --physics, or use --robot psm");
  }
  const void* const table = table_in_module("mujoco", "simulated_psm");
  if (table == nullptr) {
    throw Error(
        "--physics needs MuJoCo: install libmujoco-dev, and build keepout again with "
        "KEEPOUT_WITH_MUJOCO=ON; or install the package keepout-modules");
  }
  return (*static_cast<const MakeSimulatedPsm*>(table))(gravity);
}

}  // namespace keepout::app
