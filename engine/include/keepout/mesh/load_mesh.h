// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Which way the axes of a patient's coordinates point. RAS: x to the right, y to the front, z to
/// the head. LPS: x to the left, y to the back, z to the head. One is the other turned by half a
/// turn about z, so a mesh in the wrong one looks sound and is somewhere else.
enum class AnatomicalSpace : std::uint8_t { unstated, ras, lps };

/// "RAS", "LPS", or "unstated".
std::string_view name(AnatomicalSpace space) noexcept;

/// Turns coordinates from RAS to LPS, or back: x and y change signs, exactly. The winding stays.
void swap_ras_and_lps(Surface& surface) noexcept;

/// Whether load_mesh looks at the mesh that it has read.
enum class MeshCheck : std::uint8_t {
  quick,  // quick_check(): a unit that is not mm, an open surface, an inconsistent winding
  none    // for who calls examine(), which tells all that and more
};

/// What is known of a file, and what is wanted of it.
struct LoadOptions {
  /// The space that the coordinates shall be in: they are turned if the file says the other one.
  /// unstated: as they stand in the file.
  AnatomicalSpace space = AnatomicalSpace::unstated;
  /// The space of a file that does not say. One that does is believed.
  AnatomicalSpace untagged = AnatomicalSpace::unstated;
  MeshCheck check = MeshCheck::quick;  // whether the mesh is looked at once it is read
};

/// What load_mesh has read.
struct LoadedMesh {
  std::shared_ptr<const Mesh> mesh;                    // welded; never null
  AnatomicalSpace space = AnatomicalSpace::unstated;   // that the coordinates are in now
  AnatomicalSpace stated = AnatomicalSpace::unstated;  // that the file states: SPACE=...
  /// What was left out of the mesh, looks odd in the file, or should not be guarded with unknowing.
  std::vector<std::string> warnings = {};
};

/// Reads a triangle mesh from a file: STL, PLY (text and binary both), OBJ or OFF, by its
/// extension in any case; and welds it exactly. Polygons are triangulated. Nothing is rescaled, and
/// nothing repaired: see doctor.h. Nothing is turned either, but on demand: see LoadOptions. A file
/// that states its space (as 3D Slicer writes it) gets a warning unless `options.space` says what
/// is wanted, and one that states two is an error; so is a demand on a file of unknown space. The
/// mesh gets a warning for a size that is none of anatomy in mm, for an open surface, and for an
/// inconsistent winding.
///
/// Coordinates of binary files are exact. Those of text are the doubles nearest to the numerals; or
/// the nearest floats, where a PLY file declares floats, or where all numerals of a file may have
/// been printed from floats: with nine digits, these are the floats of its binary twin.
///
/// Throws Error, naming the file, the line where there is one, what is wrong and what to do. A file
/// that was cut short is an error; or a warning, where only the last number of a text, or the end
/// of an OBJ file, can be missing; and an OBJ file cut at the end of a line cannot be told.
LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace keepout
