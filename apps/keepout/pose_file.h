// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout::app {

/// One line of a pose file: two points, whose meaning is the reader's business. [mm]
struct PoseLine {
  Vec3 first;
  Vec3 second;
};

/// Reads lines of six numbers, separated by blanks, or by a comma with or without blanks around it;
/// blank lines and lines that begin with '#' are passed over, and so is a byte order mark at the
/// start. Throws Error naming file and line for anything else, for numbers that are not finite, for
/// a line of more than 65,535 bytes, and for a file without a pose.
std::vector<PoseLine> read_poses(const std::filesystem::path& path);

}  // namespace keepout::app
