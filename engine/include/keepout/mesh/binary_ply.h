// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "keepout/mesh/ply_header.h"

namespace keepout {

/// What was read of a file.
struct PlySurface {
  Surface surface;                    // not welded
  std::vector<std::string> warnings;  // what was left out
};

/// Reads the surface of a binary PLY file, of either byte order, not welded. Coordinates are exact,
/// in single and double precision. Polygons are cut into triangles; faces of fewer than three
/// corners are left out with a warning; other properties and elements are passed over.
///
/// `header`: read_ply_header(path), whose encoding is not text. Throws Error for a file that is
/// damaged or cut short, for one without faces, and for a coordinate that is not finite.
PlySurface read_binary_ply(const std::filesystem::path& path, const PlyHeader& header);

}  // namespace keepout
