// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
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

/// Points that a robot has measured, and the same ones in the mesh.
struct FiducialPairs {
  std::vector<Vec3> measured;      // in the robot's frame, and the unit of the file
  std::vector<Vec3> model;         // in the mesh's frame [mm]
  std::vector<double> weights;     // of each pair; or none
  std::vector<std::size_t> lines;  // of the file, from 1
};

/// Reads lines of six numbers, or seven with a weight above 0, which all or none must have, in the
/// same way. The first line may be a header, which is one without a number. Throws Error likewise.
FiducialPairs read_fiducials(const std::filesystem::path& path);

}  // namespace keepout::app
