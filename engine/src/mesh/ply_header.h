// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "binary_number.h"
#include "mesh_file.h"

namespace keepout {

// What a PLY file says of itself before its data. Source: Turk, "The PLY polygon file format",
// 1994.

/// How the data after the header are written: "ascii", one item a line, or binary.
enum class PlyEncoding { text, little_endian, big_endian };

/// A type of numbers.
struct PlyScalar : NumberType {
  std::string_view name;     // as the source has it
  std::string_view synonym;  // as others write it
};

/// What each item of an element has: one value, or a list of them.
struct PlyProperty {
  std::string name;
  const PlyScalar* type = nullptr;        // of the value, or of each one in a list
  const PlyScalar* count_type = nullptr;  // of a list; nullptr: a single value

  bool is_list() const noexcept { return count_type != nullptr; }
};

/// A table of the file, such as its vertices or its faces.
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;              // of items
  std::vector<PlyProperty> properties;  // of each item, in their order
};

/// All that is declared, in the order of the data.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  // and obj_info: what follows the word
  std::size_t size = 0;               // where the data begin [bytes]
};

/// Where the surface is among the elements of a header, which must outlive this.
struct PlyLayout {
  const PlyElement* vertex = nullptr;               // the element with the coordinates
  std::array<const PlyProperty*, 3> coordinates{};  // x, y and z among its properties
  const PlyElement* face = nullptr;                 // nullptr: there are none
  const PlyProperty* corners = nullptr;             // nullptr: there are no faces
};

/// Reads the header of a file. Throws Error, with the line, for what is malformed or not
/// understood, where more items are declared than the file has bytes, and for a header of more than
/// 16 MiB.
PlyHeader read_ply_header(const MeshSource& source);

/// Throws Error where the vertices or corners of a surface are missing, or declared twice, or where
/// it has strips.
PlyLayout find_ply_layout(const PlyHeader& header, const MeshSource& source);

}  // namespace keepout
