// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/output_file.h"

namespace keepout::app {

/// Returns true if the value of --robot names a file: with a slash, or .urdf or .xml at its end.
bool is_robot_file(const std::string& robot);

/// Returns the files of a robot that a command reads, for OutputFiles; empty for a robot of a name.
std::vector<NamedPath> robot_inputs(const std::string& robot, const std::filesystem::path& bodies);

}  // namespace keepout::app
