// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "../read_only_file.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Fourth powers of lengths must stay finite and in range; no anatomy comes near.
inline constexpr double largest_coordinate = 1e30;

/// A file that a mesh is read from, and how errors name it.
class MeshSource {
 public:
  /// Throws Error unless the path is a readable regular file that is not empty.
  explicit MeshSource(const std::filesystem::path& path);

  const std::string& name() const noexcept { return name_; }
  /// Returns the size when the file was opened. [bytes]
  std::uint64_t size() const noexcept { return file_.size(); }

  /// Reads `size` bytes from `offset` on. Returns false if the file has too few bytes.
  bool try_read(std::uint64_t offset, void* to, std::size_t size) const noexcept {
    return file_.read(offset, to, size);
  }
  /// Like try_read(), but throws Error.
  void read(std::uint64_t offset, void* to, std::size_t size) const;
  /// Returns the first bytes of the file, or all of it. Throws Error if it cannot be read.
  std::string contents(std::uint64_t at_most = UINT64_MAX) const;

  /// Throws Error with the name before `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  ReadOnlyFile file_;
};

/// The content of a mesh file.
struct MeshFile {
  Surface surface;                         // not welded
  std::vector<std::string> comments = {};  // also names and headers, where programs state facts
  std::vector<std::string> warnings = {};  // about parts that were left out

  /// Rounds coordinates to floats.
  void round_to_floats() noexcept;
};

/// The facts that the comments of a mesh file state about its coordinates.
///
/// 3D Slicer writes "SPACE=LPS" or "SPACE=RAS": in the header of an STL file ("3D Slicer output.
/// SPACE=LPS"), in the title of a legacy VTK file, in a comment of a PLY or OBJ file, and as a
/// field SPACE of a VTP file. Mimics writes into OBJ files "vertex coordinates are measured in
/// units, where 1 unit = 1000.000000 mm".
struct CoordinateNotes {
  std::string space;                  // the stated space: "RAS", "LPS", or another such as "LAS"
  std::string contradiction;          // two different stated spaces
  std::optional<double> millimetres;  // length of one unit
};

/// Reads comments in upper or lower case, with or without blanks around '='. Ignores text that is
/// no orientation, such as COLORSPACE=RGB or space = 4.
CoordinateNotes notes_of(const std::vector<std::string>& comments);

/// The size of a binary STL file's header, which is free text before the number of triangles.
/// [bytes]
constexpr std::size_t stl_header_size = 80;

/// The size including that number. Records of a normal, three corners and two bytes of attributes
/// follow, without padding. [bytes]
constexpr std::size_t stl_preamble_size = stl_header_size + sizeof(std::uint32_t);
constexpr std::size_t stl_record_size = 50;

// The readers of the formats. Each throws Error, with the line if the file has lines, for a file
// that is malformed, truncated, or without faces.

/// Reads a binary STL file and welds it at the same time, which is faster and needs little more
/// memory than the result. Ignores normals and attributes. Returns nothing if the file does not
/// have the length that its header declares. The first characters are not tested, because many
/// binary files begin with "solid".
///
/// `threads`: at most; 0 for one for each processor. The result does not depend on it.
std::optional<Surface> read_binary_stl(const MeshSource& source, unsigned threads = 0);

/// Reads a PLY file, text or binary of either byte order. Coordinates have the precision that the
/// header declares. Ignores other properties and elements.
MeshFile read_ply(const MeshSource& source);

// Coordinates in text become floats if all numerals of the file may have been printed from floats,
// and doubles otherwise.

MeshFile read_text_stl(const MeshSource& source);
MeshFile read_obj(const MeshSource& source);
MeshFile read_off(const MeshSource& source);

/// Reads a legacy VTK file of PolyData, text or binary, of version 1 to 5: polygons and triangle
/// strips. Its title is a comment, and so is a field SPACE. Reads only up to the surface.
MeshFile read_vtk(const MeshSource& source);

/// Reads an XML file of VTK with PolyData: polygons and triangle strips of all pieces. Arrays may
/// be text, base64, or appended, raw or in base64, compressed by zlib or not. A field SPACE is a
/// comment.
MeshFile read_vtp(const MeshSource& source);

}  // namespace keepout
