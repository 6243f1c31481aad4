// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "keepout/robot/chain.h"

namespace keepout {

/// One row of a table of Denavit and Hartenberg. The position of a revolute joint is added to
/// `theta`, that of a prismatic joint to `d`.
struct DenavitHartenberg {
  std::string name = {};                 // of the joint, for messages
  JointKind kind = JointKind::revolute;  // how the joint moves the links beyond it
  double a = 0.0;                        // along x [length]
  double alpha = 0.0;                    // about x [rad]
  double d = 0.0;                        // along z, at position 0 [length]
  double theta = 0.0;                    // about z, at position 0 [rad]
  JointLimits limits = {};               // of the joint's position
};

/// The order of the four transforms of a row.
enum class DhConvention : std::uint8_t {
  modified,  // Craig: about x, along x, about z, along z; the joint's axis is its own frame's z
  standard   // about z, along z, along x, about x; the joint's axis is the z of the previous frame
};

/// The joints and the flange of a table. In the standard convention the last row's a and alpha
/// define the flange; in the modified convention the flange is the last link's frame.
struct DhChain {
  std::vector<Joint> joints;  // in the order of the rows
  Pose flange;                // in the frame of the last link
};

/// Returns the joints and the flange of a table. Throws Error for a number that is not finite.
DhChain joints_of(std::span<const DenavitHartenberg> table, DhConvention convention);

}  // namespace keepout
