// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/mesh/mesh.h"
#include "verify/robot/start.h"

namespace keepout::app {

/// Where an instrument begins before a mesh, all of it farther off than the margin: as campaigns
/// begin, and if that can be found with its port out of the mesh's box, where people put it. The
/// same on every run. Throws Error, naming the mesh, when there is no room. [mm]
RobotStart instrument_start(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                            const RobotUnderTest& robot, double margin);

}  // namespace keepout::app
