// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh_file.h"

namespace keepout {

// What the XML of a VTP file says, and where the arrays are in the file. Source: "VTK XML Formats",
// Kitware.

/// An array of a VTP file.
struct VtpArray {
  /// How the numbers are written: as text, as base64, or behind the XML.
  enum class Format { text, base64, appended };

  std::string name;
  std::string type;  // such as Float32; String for text
  Format format = Format::text;
  std::uint64_t begin = 0;  // of its content in the file; in the appended data if it is there
  std::uint64_t end = 0;    // unless it is appended
  std::size_t line = 0;     // where its content begins
};

/// Cells of one kind.
struct VtpCellArrays {
  std::uint64_t count = 0;
  std::optional<VtpArray> ends;     // of each cell among the corners: "offsets"
  std::optional<VtpArray> corners;  // of all cells: "connectivity"
};

/// A part of the surface with points of its own.
struct VtpPiece {
  std::uint64_t points = 0;
  std::uint64_t left_out = 0;  // vertices and lines
  std::optional<VtpArray> coordinates;
  VtpCellArrays polygons;
  VtpCellArrays strips;
};

/// zlib unpacks a byte to no more bytes than this, so a damaged size is found before memory is
/// taken.
constexpr std::uint64_t most_unpacked = 1032;

/// What is read of the XML.
struct VtpDocument {
  bool is_big_endian = false;
  bool is_compressed = false;    // by zlib
  std::size_t count_size = 4;    // of the counts before binary data [bytes]
  bool is_raw = false;           // the appended data, which are in base64 otherwise
  std::uint64_t appended = 0;    // where they begin in the file; 0: there are none
  std::vector<VtpArray> spaces;  // of strings that name the anatomical space
  std::vector<VtpPiece> pieces;
};

/// Reads the XML by Expat, up to the appended data. Throws Error, with the line, where it is not
/// well-formed, where it is not of PolyData, and for a compression other than zlib. Throws Error
/// for UTF-16, as the arrays are read from the bytes of the file.
VtpDocument read_vtp_document(const MeshSource& source);

}  // namespace keepout
