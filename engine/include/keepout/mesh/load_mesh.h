// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
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

/// Returns the space that a text names: "RAS" or "LPS", in small letters too. Empty for any other
/// text.
std::optional<AnatomicalSpace> space_named(std::string_view text) noexcept;

/// Turns coordinates from RAS to LPS, or back: x and y change signs, exactly. The winding stays.
void swap_ras_and_lps(Surface& surface) noexcept;

/// Whether load_mesh looks at the mesh that it has read.
enum class MeshCheck : std::uint8_t {
  quick,  // quick_check(): another unit than mm, an open surface, an inconsistent winding, facing
          // inward
  none    // for who calls examine(), which tells all that and more
};

/// What is known of a file, and what is wanted of it.
struct LoadOptions {
  /// The space that the coordinates shall be in: they are turned if the file says the other one.
  /// unstated: as they stand in the file.
  AnatomicalSpace space = AnatomicalSpace::unstated;
  /// The space of a file that does not say. One that does is believed.
  AnatomicalSpace untagged = AnatomicalSpace::unstated;
  /// The unit of the lengths in the file, one of length_units(): they are scaled to mm. Empty: the
  /// file is in mm.
  std::string unit = {};
  /// The factor from lengths in the file to mm, above 0, instead of a unit.
  std::optional<double> scale = std::nullopt;
  /// True winds each triangle the other way, for a mesh whose normals point into the solid.
  bool flip = false;
  MeshCheck check = MeshCheck::quick;  // whether the mesh is looked at once it is read
};

/// What load_mesh has read.
struct LoadedMesh {
  std::shared_ptr<const Mesh> mesh;                    // welded; never null
  std::size_t vertices_in_file = 0;                    // before the weld; of STL three a triangle
  AnatomicalSpace space = AnatomicalSpace::unstated;   // that the coordinates are in now
  AnatomicalSpace stated = AnatomicalSpace::unstated;  // that the file states: SPACE=...
  double scale = 1.0;    // that the lengths of the file were multiplied by
  bool flipped = false;  // true if each triangle was wound the other way
  /// What was left out of the mesh, looks odd in the file, or must be known before the mesh guards
  /// anything: sentences that begin with the name of the file.
  std::vector<std::string> warnings = {};
  /// What was done to the mesh because of the options: scaled, turned or flipped. Sentences like
  /// those of the warnings.
  std::vector<std::string> notices = {};
};

/// Returns the extension of a file's name in lower case, with its dot: ".stl". Empty without one.
std::string lower_extension(const std::filesystem::path& path);

/// Reads a triangle mesh from a file and welds it exactly: STL, PLY, OBJ, OFF, legacy VTK or VTP,
/// by its extension in any case. Polygons are triangulated. Nothing is repaired: see diagnostics.h.
/// The mesh is scaled, turned or flipped only if the options say so, and `notices` reports it. A
/// file that states its space (as 3D Slicer writes it) gets a warning unless `options.space` says
/// what is wanted, and one that states two is an error; so is a demand on a file of unknown space.
/// A file that states a unit other than the one that it is read in gets a warning. The mesh gets a
/// warning for a size that is none of anatomy in mm, for an open surface, and for an inconsistent
/// winding.
///
/// Coordinates of binary files are exact. Those of text are the floats nearest to the numerals if a
/// PLY, VTK or VTP file declares floats, or if all numerals of a file may have been printed from
/// floats: with nine digits, these are the floats of its binary twin. Otherwise they are the
/// nearest doubles. The numerals are judged once per file, so pieces of a VTP file fit together at
/// a seam.
///
/// Throws Error for a unit or a scale that is none. Throws Error, naming the file, the line where
/// there is one, what is wrong and what to do. A file that was cut short is an error; or a warning,
/// where only the last number of a text, or the end of an OBJ file, can be missing. It cannot be
/// told if an OBJ file was cut at the end of a line, or a legacy VTK file between two sections.
LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace keepout
