// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/ply_header.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "../read_only_file.h"
#include "keepout/error.h"

namespace keepout {
namespace {

constexpr std::array<PlyScalar, 8> scalars{{{"char", "int8", 1, true, true},
                                            {"uchar", "uint8", 1, true, false},
                                            {"short", "int16", 2, true, true},
                                            {"ushort", "uint16", 2, true, false},
                                            {"int", "int32", 4, true, true},
                                            {"uint", "uint32", 4, true, false},
                                            {"float", "float32", 4, false, true},
                                            {"double", "float64", 8, false, true}}};

/// A word in quotes, fit for a message.
std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 24;
  std::string text = "'";
  for (const char c : word.substr(0, longest)) text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (word.size() > longest ? "...'" : "'");
}

/// Parses a header line by line; lines may end as on any system.
class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::string& file, std::uint64_t file_size)
      : text_(text), file_(file), file_size_(file_size) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text_.starts_with(byte_order_mark)) position_ = byte_order_mark.size();
  }

  /// Nothing if the text, which need not be the whole file, ends within the header.
  std::optional<PlyHeader> parse() {
    const bool has_line = next_line();
    if (!has_line && text_.size() < file_size_) return std::nullopt;
    if (words_.size() != 1 || words_[0] != "ply") {
      fail("expected 'ply'; if the file has another format, give it that extension");
    }
    while (next_line()) {
      if (words_[0] == "comment" || words_[0] == "obj_info") {
        // Cut short by the end of the text, it is read once more with the rest.
        const auto after =
            static_cast<std::size_t>(words_[0].data() + words_[0].size() - text_.data());
        header_.comments.emplace_back(text_.substr(after, line_end_ - after));
        continue;
      }
      if (words_[0] == "end_header") {
        // The second half of a line end may be beyond the text.
        if (position_ == text_.size() && text_.size() < file_size_) return std::nullopt;
        if (!has_format_) fail("the header has no format");
        header_.size = position_;
        return std::move(header_);
      }
      if (position_ == text_.size() && text_.size() < file_size_) return std::nullopt;
      parse_line();
    }
    if (text_.size() < file_size_) return std::nullopt;
    fail("the file ends within its header, so it was cut short; copy or export it again");
  }

 private:
  void parse_line() {
    if (words_[0] == "format") {
      header_.encoding = parse_encoding();
      has_format_ = true;
    } else if (words_[0] == "element" && words_.size() == 3) {
      header_.elements.push_back({std::string(words_[1]), whole_number(words_[2]), {}});
      // Every instance takes a byte or a line end, so more than this cannot be there.
      if (header_.elements.back().count > file_size_) {
        fail("declares " + std::string(words_[2]) + " " + quoted(words_[1]) +
             ", more than the file has room for; the file is damaged, or was cut short");
      }
    } else if (words_[0] == "property" && !header_.elements.empty()) {
      header_.elements.back().properties.push_back(parse_property());
    } else {
      fail("a header line that is not understood: " + quoted(words_[0]));
    }
  }

  PlyEncoding parse_encoding() const {
    if (words_.size() == 3 && words_[2] == "1.0") {
      if (words_[1] == "ascii") return PlyEncoding::text;
      if (words_[1] == "binary_little_endian") return PlyEncoding::little_endian;
      if (words_[1] == "binary_big_endian") return PlyEncoding::big_endian;
    }
    fail("expected 'format ascii 1.0', or binary_little_endian or binary_big_endian");
  }

  PlyProperty parse_property() const {
    if (words_.size() == 3) return {std::string(words_[2]), scalar(words_[1])};
    if (words_.size() != 5 || words_[1] != "list") fail("this property is not understood");
    const PlyProperty list{std::string(words_[4]), scalar(words_[3]), scalar(words_[2])};
    if (!list.count_type->whole) fail("the length of a list must be a whole number");
    return list;
  }

  const PlyScalar* scalar(std::string_view word) const {
    for (const PlyScalar& type : scalars) {
      if (word == type.name || word == type.synonym) return &type;
    }
    fail("unknown type " + quoted(word) + "; the file is damaged, or not PLY 1.0");
  }

  std::uint64_t whole_number(std::string_view word) const {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      fail("expected a whole number, found " + quoted(word) + "; the file is damaged");
    }
    return value;
  }

  /// Moves on to the next line that has a word; false at the end of the text.
  bool next_line() {
    words_.clear();
    while (words_.empty() && position_ < text_.size()) {
      ++line_;
      const std::size_t end = std::min(text_.find_first_of("\r\n", position_), text_.size());
      split(text_.substr(position_, end - position_));
      line_end_ = end;
      const bool two = text_.substr(end).starts_with("\r\n");
      position_ = std::min(end + (two ? 2 : 1), text_.size());
    }
    return !words_.empty();
  }

  void split(std::string_view line) {
    constexpr std::string_view spaces = " \t\f\v";
    for (std::size_t begin = 0; (begin = line.find_first_not_of(spaces, begin)) < line.size();) {
      const std::size_t end = std::min(line.find_first_of(spaces, begin), line.size());
      words_.push_back(line.substr(begin, end - begin));
      begin = end;
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(file_ + ": line " + std::to_string(line_) + ": " + what);
  }

  std::string_view text_;
  const std::string& file_;
  std::uint64_t file_size_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::size_t line_end_ = 0;  // of the line that the words are of
  std::vector<std::string_view> words_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& path) {
  const ReadOnlyFile file(path);
  if (!file.is_open()) {
    throw Error(path.string() + ": cannot be opened; check the name and the permissions");
  }
  // Headers are short, but for their comments.
  for (std::uint64_t size = 1 << 16;; size *= 4) {
    std::string beginning(std::min(size, file.size()), '\0');
    if (!file.read(0, beginning.data(), beginning.size())) {
      throw Error(path.string() + ": cannot be read to its end; check the disk");
    }
    const std::string name = path.string();
    if (auto header = HeaderParser(beginning, name, file.size()).parse()) return *header;
  }
}

PlyHeader read_ply_header(std::string_view contents, const std::string& file) {
  return *HeaderParser(contents, file, contents.size()).parse();
}

PlyLayout find_ply_layout(const PlyHeader& header, const std::string& file) {
  const auto fail = [&](const std::string& what) { throw Error(file + ": " + what); };
  PlyLayout layout;
  for (const PlyElement& element : header.elements) {
    const PlyElement** role = element.name == "vertex" ? &layout.vertex
                              : element.name == "face" ? &layout.face
                                                       : nullptr;
    if (element.name == "tristrips" && element.count > 0) {
      fail("triangle strips are not read; export the mesh as triangles");
    }
    if (role == nullptr) continue;
    if (*role != nullptr) fail("declares its " + element.name + " twice");
    *role = &element;
  }
  if (layout.vertex == nullptr) fail("has no vertices; check the export");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view name = std::string_view("xyz").substr(axis, 1);
    for (const PlyProperty& p : layout.vertex->properties) {
      if (p.name == name && !p.is_list()) layout.coordinates[axis] = &p;
    }
    if (layout.coordinates[axis] == nullptr) {
      fail("its vertices have no " + std::string(name) + "; check the export");
    }
  }
  if (layout.face == nullptr || layout.face->count == 0) return layout;
  for (const PlyProperty& p : layout.face->properties) {
    const bool has_the_name = p.name == "vertex_indices" || p.name == "vertex_index";
    if (has_the_name && p.is_list() && p.type->whole) layout.corners = &p;
  }
  if (layout.corners == nullptr) fail("its faces have no list of vertex_indices");
  return layout;
}

}  // namespace keepout
