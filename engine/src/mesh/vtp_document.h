// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh_file.h"

namespace keepout {

// The XML of a VTP file, and the places of its arrays. Source: "VTK XML Formats", Kitware.

/// An array of a VTP file.
struct VtpArray {
  /// The format of the numbers: text, base64, or appended after the XML.
  enum class Format { text, base64, appended };

  std::string name;
  std::string type;  // such as Float32; String for text
  Format format = Format::text;
  std::uint64_t begin = 0;  // of its content in the file, or in the appended data
  std::uint64_t end = 0;    // if it is not appended
  std::size_t line = 0;     // of the beginning of its content
};

/// Cells of one kind.
struct VtpCellArrays {
  std::uint64_t count = 0;
  std::optional<VtpArray> ends;     // the end of each cell in the corners: "offsets"
  std::optional<VtpArray> corners;  // of all cells: "connectivity"
};

/// A part of the surface with its own points.
struct VtpPiece {
  std::uint64_t points = 0;
  std::uint64_t left_out = 0;  // vertices and lines
  std::optional<VtpArray> coordinates;
  VtpCellArrays polygons;
  VtpCellArrays strips;
};

/// zlib unpacks a byte to at most this number of bytes, so a damaged size is detected before memory
/// is allocated.
constexpr std::uint64_t most_unpacked = 1032;

/// The parts of the XML that are needed.
struct VtpDocument {
  bool is_big_endian = false;
  bool is_compressed = false;    // by zlib
  std::size_t count_size = 4;    // of the counts before binary data [bytes]
  bool is_raw = false;           // the appended data are raw, not base64
  std::uint64_t appended = 0;    // their offset in the file; 0: no appended data
  std::vector<VtpArray> spaces;  // arrays of strings that name the anatomical space
  std::vector<VtpPiece> pieces;
};

/// Reads the XML by Expat, up to the appended data. Throws Error, with the line, for XML that is
/// not well-formed or not of PolyData, and for a compression other than zlib. Throws Error for
/// UTF-16, because the arrays are read from the bytes of the file.
VtpDocument read_vtp_document(const MeshSource& source);

}  // namespace keepout
