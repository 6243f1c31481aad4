// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// What is in a mesh file.
struct MeshFile {
  Surface surface;                    // not welded
  std::vector<std::string> comments;  // and names and headers: where programs state what they like
  std::vector<std::string> warnings;  // on what was left out

  /// Rounds coordinates to floats.
  void round_to_floats() noexcept;
};

/// What a binary STL file begins with, before the number of its triangles: free text. [bytes]
constexpr std::size_t stl_header_size = 80;

// The readers of each format. Each throws Error, with the line where there are lines, for anything
// that is malformed, cut short, or has no faces. `file` names the file in errors.

/// A PLY file, text or binary of either byte order. Coordinates are of the precision that the
/// header declares; other properties and elements are passed over.
MeshFile read_ply(const std::filesystem::path& path);

// Coordinates of text are floats where all of its numerals may have been printed from floats, and
// doubles elsewhere.

MeshFile read_text_stl(std::string_view contents, const std::string& file);
MeshFile read_obj(std::string_view contents, const std::string& file);
MeshFile read_off(std::string_view contents, const std::string& file);

/// What a file begins with, or all of it. Throws Error if it cannot be read.
std::string contents_of(const std::filesystem::path& path, std::uint64_t at_most = UINT64_MAX);

}  // namespace keepout
