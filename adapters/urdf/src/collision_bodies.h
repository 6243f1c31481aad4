// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "keepout/robot/instrument.h"
#include "urdf_chain.h"

namespace keepout {

/// Returns bodies that contain the collision elements of all links that the chain carries: see
/// read_robot. `folder`: that of the URDF, for mesh files. Appends to `notices`. Throws Error.
std::vector<Body> bodies_of_collisions(const UrdfDescription& read, const UrdfChain& chain,
                                       const std::filesystem::path& folder, double scale,
                                       std::vector<std::string>& notices);

}  // namespace keepout
