// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/adapters/anatomical_space.h"

namespace keepout {

/// What the comments of a mesh file say of its coordinates.
///
/// 3D Slicer writes "SPACE=LPS" or "SPACE=RAS": in the header of an STL file ("3D Slicer output.
/// SPACE=LPS"), in a comment of a PLY or OBJ file. Mimics writes into OBJ files "vertex coordinates
/// are measured in units, where 1 unit = 1000.000000 mm".
struct CoordinateNotes {
  AnatomicalSpace space = AnatomicalSpace::unstated;
  std::string other_space;            // stated, but neither RAS nor LPS: such as "LAS"
  std::string contradiction;          // two spaces that were both stated
  std::optional<double> millimetres;  // that one unit is
};

/// Takes in one comment after another, in upper or lower case, with or without blanks around '='.
/// What is no orientation, such as COLORSPACE=RGB or space = 4, is passed over.
void read_notes(std::string_view comment, CoordinateNotes& notes);

/// Comments, in the form that a format has them: of a text, each is handed to read_notes.
/// Binary STL: its header of 80 bytes.
CoordinateNotes notes_of_binary_stl(std::string_view beginning);
/// Text STL: the names after "solid" and "endsolid".
CoordinateNotes notes_of_text_stl(std::string_view contents);
/// PLY: its comments and obj_info.
CoordinateNotes notes_of_ply(const std::vector<std::string>& comments);
/// OBJ and OFF: what follows a '#', up to the end of the line.
CoordinateNotes notes_after_hashes(std::string_view contents);

}  // namespace keepout
