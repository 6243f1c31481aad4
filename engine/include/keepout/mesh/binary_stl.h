// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>

#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Writes a binary STL file: whole or not at all, for it is renamed into place when complete.
/// Coordinates are rounded to single precision, which is all that the format holds. Throws Error,
/// also when a coordinate does not fit, when a triangle names a vertex that does not exist, and
/// when something else than a file stands there, such as a pipe or a device. load_mesh() reads it
/// back.
void write_binary_stl(const std::filesystem::path& path, const Surface& surface);

/// The same, triangle by triangle, for surfaces that no memory holds: triangle(t) is called for 0
/// to `triangles` - 1, in this order. What it throws is passed on, and nothing is left of the file.
void write_binary_stl(const std::filesystem::path& path, std::uint64_t triangles,
                      const std::function<Triangle(std::uint64_t)>& triangle);

/// Like write_binary_stl(path, surface), but writes to a binary stream, whose state the caller must
/// check. The header states `space` if it is known, as 3D Slicer writes it.
void write_binary_stl(std::ostream& out, const Surface& surface, AnatomicalSpace space);

}  // namespace keepout
