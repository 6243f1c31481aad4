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
  /// Throws Error unless there is a regular file with something in it that may be read.
  explicit MeshSource(const std::filesystem::path& path);

  const std::string& name() const noexcept { return name_; }
  /// As it was when opened. [bytes]
  std::uint64_t size() const noexcept { return file_.size(); }

  /// Reads `size` bytes from `offset` on; false if they are not all to be had.
  bool try_read(std::uint64_t offset, void* to, std::size_t size) const noexcept {
    return file_.read(offset, to, size);
  }
  /// The same, but throws Error.
  void read(std::uint64_t offset, void* to, std::size_t size) const;
  /// What the file begins with, or all of it. Throws Error if it cannot be read.
  std::string contents(std::uint64_t at_most = UINT64_MAX) const;

  /// Throws Error with the name before `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  ReadOnlyFile file_;
};

/// What is in a mesh file.
struct MeshFile {
  Surface surface;                         // not welded
  std::vector<std::string> comments = {};  // names and headers too: where programs state things
  std::vector<std::string> warnings = {};  // on what was left out

  /// Rounds coordinates to floats.
  void round_to_floats() noexcept;
};

/// What the comments of a mesh file say of its coordinates.
///
/// 3D Slicer writes "SPACE=LPS" or "SPACE=RAS": in the header of an STL file ("3D Slicer output.
/// SPACE=LPS"), in the title of a legacy VTK file, in a comment of a PLY or OBJ file, and as a
/// field SPACE of a VTP file. Mimics writes into OBJ files "vertex coordinates are measured in
/// units, where 1 unit = 1000.000000 mm".
struct CoordinateNotes {
  std::string space;                  // that is stated: "RAS", "LPS", or another such as "LAS"
  std::string contradiction;          // two spaces that were both stated
  std::optional<double> millimetres;  // that one unit is
};

/// Comments in upper or lower case, with or without blanks around '='. What is no orientation, such
/// as COLORSPACE=RGB or space = 4, is passed over.
CoordinateNotes notes_of(const std::vector<std::string>& comments);

/// What a binary STL file begins with, before the number of its triangles: free text. [bytes]
constexpr std::size_t stl_header_size = 80;

/// And with that number. Behind it are records of a normal, three corners and two bytes of
/// attributes, without padding. [bytes]
constexpr std::size_t stl_preamble_size = stl_header_size + sizeof(std::uint32_t);
constexpr std::size_t stl_record_size = 50;

// The readers of each format. Each throws Error, with the line where there are lines, for anything
// that is malformed, cut short, or has no faces.

/// Reads a binary STL file and welds it at once, as faster than one after the other, and in little
/// more memory than the result takes; normals and attributes are ignored. Nothing if the file is
/// not as long as the binary STL that its header declares. What it begins with does not matter, for
/// many a binary file begins with "solid".
///
/// `threads`: at most; 0 for as many as there are processors. The result is the same.
std::optional<Surface> read_binary_stl(const MeshSource& source, unsigned threads = 0);

/// A PLY file, text or binary of either byte order. Coordinates are of the precision that the
/// header declares; other properties and elements are passed over.
MeshFile read_ply(const MeshSource& source);

// Coordinates of text are floats if all numerals of the file may have been printed from floats, and
// doubles otherwise.

MeshFile read_text_stl(const MeshSource& source);
MeshFile read_obj(const MeshSource& source);
MeshFile read_off(const MeshSource& source);

/// A legacy VTK file of PolyData, text or binary, of version 1 to 5: polygons and triangle strips.
/// Its title is a comment, and so is a field SPACE. Reads no further than the surface.
MeshFile read_vtk(const MeshSource& source);

/// An XML file of VTK with PolyData: polygons and triangle strips of all pieces; arrays as text, as
/// base64, or appended, raw or in base64; compressed by zlib or not. A field SPACE is a comment.
MeshFile read_vtp(const MeshSource& source);

}  // namespace keepout
