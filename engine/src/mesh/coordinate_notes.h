// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace keepout {

/// What the comments of a mesh file say of its coordinates.
///
/// 3D Slicer writes "SPACE=LPS" or "SPACE=RAS": in the header of an STL file ("3D Slicer output.
/// SPACE=LPS"), in a comment of a PLY or OBJ file. Mimics writes into OBJ files "vertex coordinates
/// are measured in units, where 1 unit = 1000.000000 mm".
struct CoordinateNotes {
  std::string space;                  // that is stated: "RAS", "LPS", or another such as "LAS"
  std::string contradiction;          // two spaces that were both stated
  std::optional<double> millimetres;  // that one unit is
};

/// Comments in upper or lower case, with or without blanks around '='. What is no orientation, such
/// as COLORSPACE=RGB or space = 4, is passed over.
CoordinateNotes notes_of(const std::vector<std::string>& comments);

}  // namespace keepout
