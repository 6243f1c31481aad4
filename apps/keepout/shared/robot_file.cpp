// SPDX-License-Identifier: BSD-3-Clause
#include "shared/robot_file.h"

namespace keepout::app {

bool is_robot_file(const std::string& robot) {
  return robot.find('/') != std::string::npos || robot.ends_with(".urdf") ||
         robot.ends_with(".xml");
}

std::vector<NamedPath> robot_inputs(const std::string& robot, const std::filesystem::path& bodies) {
  std::vector<NamedPath> inputs;
  if (is_robot_file(robot)) inputs.push_back({"--robot", robot});
  if (!bodies.empty()) inputs.push_back({"--bodies", bodies});
  return inputs;
}

}  // namespace keepout::app
