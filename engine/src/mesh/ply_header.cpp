// SPDX-License-Identifier: BSD-3-Clause
#include "ply_header.h"

#include <algorithm>
#include <optional>

#include "text_lines.h"

namespace keepout {
namespace {

constexpr std::array<PlyScalar, 8> scalars{{{{1, true, true}, "char", "int8"},
                                            {{1, true, false}, "uchar", "uint8"},
                                            {{2, true, true}, "short", "int16"},
                                            {{2, true, false}, "ushort", "uint16"},
                                            {{4, true, true}, "int", "int32"},
                                            {{4, true, false}, "uint", "uint32"},
                                            {{4, false, true}, "float", "float32"},
                                            {{8, false, true}, "double", "float64"}}};

constexpr std::uint64_t longest_header = std::uint64_t{16} << 20;  // [bytes]

const PlyScalar* scalar(const TextLines& lines, std::string_view word) {
  for (const PlyScalar& type : scalars) {
    if (word == type.name || word == type.synonym) return &type;
  }
  lines.fail("unknown type " + in_quotes(word) + "; the file is damaged, or not PLY 1.0");
}

PlyEncoding parse_encoding(const TextLines& lines) {
  const auto words = lines.words();
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return PlyEncoding::text;
    if (words[1] == "binary_little_endian") return PlyEncoding::little_endian;
    if (words[1] == "binary_big_endian") return PlyEncoding::big_endian;
  }
  lines.fail("expected 'format ascii 1.0', or binary_little_endian or binary_big_endian");
}

PlyElement parse_element(const TextLines& lines, std::uint64_t file_size) {
  const auto words = lines.words();
  const std::uint64_t count = lines.whole_number(words[2]);
  // Every item takes a byte or a line end, so the file cannot have more items.
  if (count > file_size) {
    lines.fail("declares " + std::string(words[2]) + " " + in_quotes(words[1]) +
               ", more than the file has room for; the file is damaged, or was cut short");
  }
  return {std::string(words[1]), count, {}};
}

PlyProperty parse_property(const TextLines& lines) {
  const auto words = lines.words();
  if (words.size() == 3) return {std::string(words[2]), scalar(lines, words[1])};
  if (words.size() != 5 || words[1] != "list") lines.fail("unknown form of a property");
  const PlyProperty list{std::string(words[4]), scalar(lines, words[3]), scalar(lines, words[2])};
  if (!list.count_type->whole) lines.fail("the length of a list must be a whole number");
  return list;
}

/// Parses a header. Returns nothing if the header continues after the text, which is the beginning
/// of a file up to a line end.
std::optional<PlyHeader> parse_header(TextLines& lines, std::uint64_t file_size) {
  PlyHeader header;
  bool has_format = false;
  if (!lines.next() || lines.words().size() != 1 || lines.words()[0] != "ply") {
    lines.fail("expected 'ply'; if the file has another format, give it that extension");
  }
  while (lines.next()) {
    const auto words = lines.words();
    if (words[0] == "comment" || words[0] == "obj_info") {
      header.comments.emplace_back(lines.after(words[0]));
    } else if (words[0] == "format") {
      header.encoding = parse_encoding(lines);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back(parse_element(lines, file_size));
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parse_property(lines));
    } else if (words[0] == "end_header") {
      if (!has_format) lines.fail("the header has no format");
      header.size = lines.position();
      return header;
    } else {
      lines.fail("a header line that is not understood: " + in_quotes(words[0]));
    }
  }
  return std::nullopt;
}

/// Chooses a property for its role. Throws Error if there is a second one, because it would be
/// lost.
void choose(const PlyProperty*& chosen, const PlyProperty& property, std::string_view name,
            const MeshSource& source) {
  if (chosen != nullptr) {
    source.fail("declares its " + std::string(name) + " twice; check the export");
  }
  chosen = &property;
}

}  // namespace

PlyHeader read_ply_header(const MeshSource& source) {
  // Headers are short, except for their comments.
  for (std::uint64_t size = 1 << 16; size <= longest_header; size *= 4) {
    std::string beginning = source.contents(size);
    const bool is_all = beginning.size() == source.size();
    if (!is_all) {
      if (beginning.back() == '\r') beginning.pop_back();  // it may be half of a CRLF
      beginning.resize(beginning.find_last_of("\r\n") + 1);
      if (beginning.empty()) continue;
    }
    TextLines lines(std::move(beginning), source.name());
    if (auto header = parse_header(lines, source.size())) return *std::move(header);
    if (is_all) {
      lines.fail("the file ends within its header, so it was cut short; copy or export it again");
    }
  }
  source.fail("its header does not end within 16 MiB; the file is damaged");
}

PlyLayout find_ply_layout(const PlyHeader& header, const MeshSource& source) {
  PlyLayout layout;
  for (const PlyElement& element : header.elements) {
    const PlyElement** role = element.name == "vertex" ? &layout.vertex
                              : element.name == "face" ? &layout.face
                                                       : nullptr;
    if (element.name == "tristrips" && element.count > 0) {
      source.fail("triangle strips are not read; export the mesh as triangles");
    }
    if (role == nullptr) continue;
    if (*role != nullptr) source.fail("declares its " + element.name + " twice; check the export");
    *role = &element;
  }
  if (layout.vertex == nullptr) source.fail("has no vertices; check the export");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view name = std::string_view("xyz").substr(axis, 1);
    for (const PlyProperty& p : layout.vertex->properties) {
      if (p.name == name && !p.is_list()) choose(layout.coordinates[axis], p, name, source);
    }
    if (layout.coordinates[axis] == nullptr) {
      source.fail("its vertices have no " + std::string(name) + "; check the export");
    }
  }
  if (layout.face == nullptr || layout.face->count == 0) return layout;
  for (const PlyProperty& p : layout.face->properties) {
    const bool has_the_name = p.name == "vertex_indices" || p.name == "vertex_index";
    if (has_the_name && p.is_list() && p.type->whole) {
      choose(layout.corners, p, "vertex_indices", source);
    }
  }
  if (layout.corners == nullptr) source.fail("its faces have no list of vertex_indices");
  return layout;
}

}  // namespace keepout
