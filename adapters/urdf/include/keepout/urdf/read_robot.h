// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/robot/instrument.h"

namespace keepout {

/// A robot from files: its instrument, and names for messages.
struct UrdfRobot {
  std::string name;                // the robot's name in the URDF
  Instrument instrument;           // the chain from base to tip, and its bodies
  std::vector<std::string> links;  // [k]: the link that joint k moves; [0]: the base
  /// Sentences about links that no body guards, and about doubtful mesh files.
  std::vector<std::string> notices = {};
};

/// Reads a robot from a URDF and a JSON file of its bodies (docs/robots.md has the format). `base`
/// and `tip`: links, as in read_chain; if empty, those of the JSON file. `scale`: the length of a
/// meter in the mesh's unit, 1000 for mm.
///
/// If `bodies` is empty, or its file has no bodies, the collision elements of all links that the
/// chain carries become bodies. A sphere becomes a ball, every other shape a capsule that contains
/// it. Radii are rounded up, so that no rounding leaves a part of the shape outside. The body that
/// comes nearest to the tip is the last one.
///
/// Throws Error, which names file, field or element, and what to do, like read_chain. Also throws
/// Error for a JSON file of another format, and for invalid bodies (see Instrument). Without bodies
/// in a file, throws Error for a shape that cannot be read. Also throws Error then for a shape that
/// a joint outside of the chain moves, and unless there are 1 to Instrument::most_bodies shapes.
UrdfRobot read_robot(const std::filesystem::path& urdf, const std::filesystem::path& bodies = {},
                     std::string_view base = {}, std::string_view tip = {}, double scale = 1000.0);

}  // namespace keepout
