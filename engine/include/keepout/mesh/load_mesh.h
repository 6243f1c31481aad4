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

/// The directions of the axes of patient coordinates. RAS: x to the right, y to the front, z to the
/// head. LPS: x to the left, y to the back, z to the head. The two differ by half a turn about z,
/// so a mesh in the wrong space looks correct but is in another place.
enum class AnatomicalSpace : std::uint8_t { unstated, ras, lps };

/// Returns "RAS", "LPS", or "unstated".
std::string_view name(AnatomicalSpace space) noexcept;

/// Returns the space that a text names: "RAS" or "LPS", in upper or lower case. Empty for any other
/// text.
std::optional<AnatomicalSpace> space_named(std::string_view text) noexcept;

/// Converts coordinates from RAS to LPS or back: changes the signs of x and y, exactly. The winding
/// does not change.
void swap_ras_and_lps(Surface& surface) noexcept;

/// The check that load_mesh makes of a mesh.
enum class MeshCheck : std::uint8_t {
  quick,  // quick_check(): unit, open surface, inconsistent winding, surface that faces inward
  none    // no check, for callers of examine(), which finds more
};

/// Properties of a file, and how to convert its mesh.
struct LoadOptions {
  /// The space of the loaded coordinates: they are converted if the file states the other space.
  /// unstated: as in the file.
  AnatomicalSpace space = AnatomicalSpace::unstated;
  /// The space of a file that does not state one. If the file states a space, this is ignored.
  AnatomicalSpace untagged = AnatomicalSpace::unstated;
  /// The unit of the lengths in the file, one of length_units(); lengths are scaled to mm. Empty:
  /// mm.
  std::string unit = {};
  /// The factor from lengths in the file to mm, above 0, instead of a unit.
  std::optional<double> scale = std::nullopt;
  /// True reverses the winding of each triangle, for a mesh whose normals point into the solid.
  bool flip = false;
  MeshCheck check = MeshCheck::quick;  // the check after reading
};

/// The result of load_mesh.
struct LoadedMesh {
  std::shared_ptr<const Mesh> mesh;  // welded; never null
  std::size_t vertices_in_file = 0;  // before the weld; in STL, three for each triangle
  AnatomicalSpace space = AnatomicalSpace::unstated;   // of the loaded coordinates
  AnatomicalSpace stated = AnatomicalSpace::unstated;  // as stated in the file: SPACE=...
  double scale = 1.0;    // the factor by which the lengths of the file were multiplied
  bool flipped = false;  // true if the winding was reversed
  /// Warnings about omitted data, suspicious contents of the file, and faults of the mesh that
  /// affect a constraint. Sentences that begin with the name of the file.
  std::vector<std::string> warnings = {};
  /// Conversions of the mesh by the options: scaled, turned or flipped. Sentences like the
  /// warnings.
  std::vector<std::string> notices = {};
};

/// Returns the extension of a file's name in lower case, with its dot: ".stl". Empty without one.
std::string lower_extension(const std::filesystem::path& path);

/// Reads a triangle mesh from a file and welds exactly equal vertices. The extension, in upper or
/// lower case, gives the format: STL, PLY, OBJ, OFF, legacy VTK or VTP. Polygons are triangulated.
/// Nothing is repaired: see diagnostics.h. The mesh is scaled, turned or flipped only if the
/// options say so, and `notices` reports it.
///
/// Warns if the file states a space, as 3D Slicer does, and `options.space` is unstated. Warns if
/// the file states another unit than the one that it is read in. With MeshCheck::quick, also gives
/// the warnings of quick_check().
///
/// Coordinates of binary files are exact. Coordinates of text files are rounded to floats if the
/// file declares floats (PLY, VTK, VTP), or if all its numbers may be printed floats. If they have
/// nine digits, these are the floats of the equivalent binary file. Otherwise coordinates are
/// rounded to doubles. The decision applies to the whole file, so that pieces of a VTP file fit
/// together at a seam.
///
/// Throws Error for an invalid unit or scale. Throws Error, which names file, line, cause and
/// remedy, for a file that cannot be read. Also throws Error for a file that states two spaces, or
/// has no known space although `options.space` requires one. A truncated file is an error. But if
/// only the last number of a text file, or the end of an OBJ file, can be missing, it is a warning.
/// Truncation of an OBJ file at the end of a line, or of a legacy VTK file between two sections,
/// cannot be detected.
LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace keepout
