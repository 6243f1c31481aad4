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

// The header of a PLY file. Source: Turk, "The PLY polygon file format", 1994.

/// The encoding of the data after the header: "ascii" with one item a line, or binary.
enum class PlyEncoding { text, little_endian, big_endian };

/// A type of numbers.
struct PlyScalar : NumberType {
  std::string_view name;     // in the source
  std::string_view synonym;  // in other programs
};

/// A property of each item of an element: one value, or a list.
struct PlyProperty {
  std::string name;
  const PlyScalar* type = nullptr;        // of the value, or of each value in a list
  const PlyScalar* count_type = nullptr;  // of a list; nullptr: a single value

  bool is_list() const noexcept { return count_type != nullptr; }
};

/// A table of the file, such as its vertices or its faces.
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;              // of items
  std::vector<PlyProperty> properties;  // of each item, in their order
};

/// The declarations of a header, in the order of the data.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  // and obj_info: the text after the word
  std::size_t size = 0;               // offset of the data [bytes]
};

/// The places of the surface in a header, which must outlive this object.
struct PlyLayout {
  const PlyElement* vertex = nullptr;               // the element with the coordinates
  std::array<const PlyProperty*, 3> coordinates{};  // x, y and z among its properties
  const PlyElement* face = nullptr;                 // null if there are no faces
  const PlyProperty* corners = nullptr;             // null if there are no faces
};

/// Reads the header of a file. Throws Error, with the line, for a header that is malformed, has
/// unknown parts, or declares more items than the file has bytes. Throws Error for a header of more
/// than 16 MiB.
PlyHeader read_ply_header(const MeshSource& source);

/// Finds the surface in a header. Throws Error if vertices or corners are missing or declared
/// twice, or if the file has strips.
PlyLayout find_ply_layout(const PlyHeader& header, const MeshSource& source);

}  // namespace keepout
