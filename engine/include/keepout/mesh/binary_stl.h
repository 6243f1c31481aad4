// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>

#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Writes a binary STL file completely or not at all, by renaming a temporary file. Coordinates are
/// rounded to single precision, as the format requires. Throws Error if the file cannot be written,
/// or the path is a pipe or a device. Also throws Error if a coordinate does not fit, or a triangle
/// names a vertex that does not exist. load_mesh() reads the file back.
void write_binary_stl(const std::filesystem::path& path, const Surface& surface);

/// Like write_binary_stl(path, surface), for surfaces larger than the memory: calls triangle(t) for
/// t from 0 to `triangles` - 1, in this order. If `triangle` throws, the exception is passed on and
/// no file is left.
void write_binary_stl(const std::filesystem::path& path, std::uint64_t triangles,
                      const std::function<Triangle(std::uint64_t)>& triangle);

/// Like write_binary_stl(path, surface), but writes to a binary stream, whose state the caller must
/// check. The header states `space` if it is known, as 3D Slicer writes it.
void write_binary_stl(std::ostream& out, const Surface& surface, AnatomicalSpace space);

}  // namespace keepout
