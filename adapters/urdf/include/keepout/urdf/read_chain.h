// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/robot/chain.h"

namespace keepout {

/// A serial chain from a robot description in URDF (Unified Robot Description Format). `joints` and
/// `flange` are arguments of Chain. Fixed joints are part of the transforms between moving joints.
struct UrdfChain {
  std::string robot;               // the robot's name in the file
  std::vector<Joint> joints;       // the moving joints, from the base on
  Pose flange;                     // the tip, in the frame of the last moving link
  std::vector<std::string> links;  // [k]: the link that joint k moves; [0]: the base
};

/// Reads the chain from link `base` to link `tip`. An empty `base` means the root; an empty `tip`
/// means the only leaf below the base. `scale`: the length of a meter in the mesh's unit, 1000 for
/// mm. It multiplies lengths and limits of prismatic joints.
///
/// Throws Error, which names file and joint, for a file that cannot be read or is not a URDF. Also
/// throws Error for a link that does not exist or is not below the base, and for several leaves,
/// two parents or a loop. Between base and tip, throws Error for these faults:
/// 1. Axes that are zero, or not unit vectors to three digits.
/// 2. Limits that are missing, empty or not finite, and velocities not above 0.
/// 3. Floating, planar and mimic joints, and duplicate elements.
/// 4. No moving joint, or more than Chain::most_joints.
///
/// Ignores effort and safety_controller. Allocates. Suppresses messages of urdfdom. During the
/// call, messages of other threads through console_bridge are lost.
UrdfChain read_chain(const std::filesystem::path& file, std::string_view base, std::string_view tip,
                     double scale = 1000.0);

/// Like read_chain, for a text. `name`: the name of the text in messages.
UrdfChain parse_chain(std::string_view text, std::string_view name, std::string_view base,
                      std::string_view tip, double scale = 1000.0);

}  // namespace keepout
