// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// What load_mesh has read.
struct LoadedMesh {
  std::shared_ptr<const Mesh> mesh;   // welded; never null
  std::vector<std::string> warnings;  // what was left out of the mesh, or looks odd in the file
};

/// Reads a triangle mesh from a file: STL, PLY (text and binary both), OBJ or OFF, by its
/// extension in any case; and welds it exactly. Polygons are triangulated. Nothing is rescaled, and
/// nothing repaired: see doctor.h.
///
/// Coordinates of binary files are exact, also doubles of PLY. Those of text files arrive in single
/// precision: those of PLY are the nearest, and those of the others within 1 unit in the last
/// place, or 2 when written with an exponent. The same mesh may differ by that much from one format
/// to another.
///
/// Throws Error, naming the file, the line where there is one, what is wrong and what to do. A file
/// that was cut short is an error, except that an OBJ file cut at the end of a line cannot be told.
LoadedMesh load_mesh(const std::filesystem::path& path);

}  // namespace keepout
