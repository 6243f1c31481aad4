// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/robot/chain.h"

namespace keepout {

/// A serial chain out of a robot's description: joints and flange are what Chain takes. Fixed
/// joints are part of the ways between those that move.
struct UrdfChain {
  std::string robot;               // its name in the file
  std::vector<Joint> joints;       // those that move, from the base on
  Pose flange;                     // the tip, in the frame of the last link that moves
  std::vector<std::string> links;  // [k]: the link that joint k moves; [0]: the base
};

/// Reads the chain from link `base` to link `tip`. An empty `base` is the root; an empty `tip` the
/// only leaf below the base. `scale`: a meter in the mesh's unit, 1000 for mm; multiplies lengths,
/// and limits of prismatic joints.
///
/// Throws Error, naming file and joint, for what is unreadable or no URDF, links that are not there
/// or not below the base, more than one leaf, two parents, a loop; and on the way to the tip for
/// axes that are zero or not unit to three digits, limits that are missing, empty or not finite,
/// velocities not above zero, joints that float, are planar or mimic, what is there twice, none or
/// more than Chain::most_joints that move. Looks at no effort and no safety_controller. Allocates.
/// urdfdom prints nothing meanwhile; other threads' messages through console_bridge are lost.
UrdfChain read_chain(const std::filesystem::path& file, std::string_view base, std::string_view tip,
                     double scale = 1000.0);

/// The same, of a text; `name` is what messages call it.
UrdfChain parse_chain(std::string_view text, std::string_view name, std::string_view base,
                      std::string_view tip, double scale = 1000.0);

}  // namespace keepout
