// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout::app {

/// One line of a pose file: two points, whose meaning the caller defines. [mm]
struct PoseLine {
  Vec3 first;
  Vec3 second;
};

/// Reads lines of six numbers, separated by blanks, or by a comma with or without blanks around it.
/// Ignores blank lines, lines that begin with '#' and a byte order mark at the start. Throws Error
/// with file and line for any other line, and for a number that is not finite. Throws Error for a
/// line of more than 65,535 bytes, and for a file without a pose.
std::vector<PoseLine> read_poses(const std::filesystem::path& path);

/// Points that a robot has measured, and the corresponding points of the mesh.
struct FiducialPairs {
  std::vector<Vec3> measured;      // in the robot's frame and the unit of the file
  std::vector<Vec3> model;         // in the mesh's frame [mm]
  std::vector<double> weights;     // of each pair; or empty
  std::vector<std::size_t> lines;  // the line numbers in the file, from 1
};

/// Reads lines of six numbers, or of seven with a weight above 0, which all lines or no line must
/// have. Format and errors are those of read_poses(). The first line may be a header: a line
/// without a number.
FiducialPairs read_fiducials(const std::filesystem::path& path);

}  // namespace keepout::app
