// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <span>

#include "keepout/error.h"
#include "screen.h"
#include "text_lines.h"

namespace keepout {
namespace {

using WordSpan = std::span<const std::string_view>;

struct ScalarType {
  std::string_view name;     // as assimp knows it
  std::string_view synonym;  // as others write it
  std::size_t size;          // [bytes]
  bool whole, is_signed;
};

constexpr std::array<ScalarType, 8> scalar_types{{{"char", "int8", 1, true, true},
                                                  {"uchar", "uint8", 1, true, false},
                                                  {"short", "int16", 2, true, true},
                                                  {"ushort", "uint16", 2, true, false},
                                                  {"int", "int32", 4, true, true},
                                                  {"uint", "uint32", 4, true, false},
                                                  {"float", "float32", 4, false, true},
                                                  {"double", "float64", 8, false, true}}};

struct Property {
  std::string_view name;
  const ScalarType* type = nullptr;
  const ScalarType* count_type = nullptr;  // of a list; nullptr: a single value
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { text, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
};

const ScalarType* scalar_type(const TextLines& lines, std::string_view word) {
  for (const ScalarType& type : scalar_types) {
    if (word == type.name || word == type.synonym) return &type;
  }
  lines.fail("unknown type " + quoted(word) + "; the file is damaged, or not PLY 1.0");
}

Property parse_property(const TextLines& lines, WordSpan words) {
  if (words.size() == 3) return {words[2], scalar_type(lines, words[1])};
  if (words.size() != 5 || words[1] != "list") lines.fail("this property is not understood");
  Property list{words[4], scalar_type(lines, words[3]), scalar_type(lines, words[2])};
  if (!list.count_type->whole) lines.fail("the length of a list must be a whole number");
  return list;
}

Encoding parse_encoding(const TextLines& lines, WordSpan words) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return Encoding::text;
    if (words[1] == "binary_little_endian") return Encoding::little_endian;
    if (words[1] == "binary_big_endian") return Encoding::big_endian;
  }
  lines.fail("expected 'format ascii 1.0', or binary_little_endian or binary_big_endian");
}

/// Reads up to and with end_header, and leaves `lines` there.
Header parse_header(TextLines& lines, std::size_t file_size) {
  if (!lines.next() || lines.words().size() != 1 || lines.words()[0] != "ply") {
    lines.fail("expected 'ply'; if the file has another format, give it that extension");
  }
  Header header;
  bool has_format = false;
  while (lines.next()) {
    const WordSpan words = lines.words();
    if (words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      if (!has_format) lines.fail("the header has no format");
      return header;
    }
    if (words[0] == "format") {
      header.encoding = parse_encoding(lines, words);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back({words[1], lines.whole_number(words[2]), {}});
      // Every instance takes a byte or a line end, so more than this cannot be there.
      if (header.elements.back().count > file_size) {
        lines.fail("declares " + std::string(words[2]) + " " + quoted(words[1]) +
                   ", more than the file has room for; the file is damaged, or was cut short");
      }
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parse_property(lines, words));
    } else {
      lines.fail("a header line that is not understood: " + quoted(words[0]));
    }
  }
  lines.fail("the file ends within its header, so it was cut short; copy or export it again");
}

/// The values of one instance after the other, from a text or from bytes: what both bodies share.
/// Each value is handed over as it stands in the file.
class Body {
 public:
  virtual ~Body() = default;
  virtual void begin_instance() = 0;
  virtual std::string_view take(const ScalarType& type) = 0;
  virtual std::uint64_t take_whole(const ScalarType& type) = 0;
  virtual void end_instance() = 0;
  [[noreturn]] virtual void fail(const std::string& what) const = 0;
  /// True if nothing follows.
  virtual bool at_end() = 0;

  /// The instance being read, for errors.
  std::string place;
};

class TextBody final : public Body {
 public:
  explicit TextBody(TextLines& lines) : lines_(lines) {}

  void begin_instance() override {
    used_ = 0;
    if (!lines_.next()) fail("the file ends before its last " + place + ", so it was cut short");
  }
  std::string_view take(const ScalarType&) override {
    const std::string_view word = take_word();
    lines_.expect_number(word);
    return word;
  }
  std::uint64_t take_whole(const ScalarType&) override { return lines_.whole_number(take_word()); }
  void end_instance() override {
    if (used_ != lines_.words().size()) fail("more values than the header declares for a " + place);
  }
  void fail(const std::string& what) const override { lines_.fail(what); }
  bool at_end() override { return !lines_.next(); }

 private:
  std::string_view take_word() {
    if (used_ == lines_.words().size()) {
      fail("fewer values than the header declares for a " + place + "; the file is damaged");
    }
    return lines_.words()[used_++];
  }

  TextLines& lines_;
  std::size_t used_ = 0;
};

class BinaryBody final : public Body {
 public:
  BinaryBody(std::string_view bytes, bool big_endian, std::string file)
      : bytes_(bytes), big_endian_(big_endian), file_(std::move(file)) {}

  void begin_instance() override {}
  std::string_view take(const ScalarType& type) override {
    if (bytes_.size() < type.size) {
      fail("the file ends before its last " + place +
           ", so it was cut short; copy or export it again");
    }
    const std::string_view value = bytes_.substr(0, type.size);
    bytes_.remove_prefix(type.size);
    return value;
  }
  std::uint64_t take_whole(const ScalarType& type) override {
    std::string_view value = take(type);
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::size_t significance = big_endian_ ? value.size() - 1 - i : i;
      number |= std::uint64_t{static_cast<unsigned char>(value[i])} << (8 * significance);
    }
    if (type.is_signed && (number >> (8 * value.size() - 1)) != 0) {
      fail("a negative length or index at a " + place + "; the file is damaged");
    }
    return number;
  }
  void end_instance() override {}
  void fail(const std::string& what) const override { throw Error(file_ + ": " + what); }
  bool at_end() override { return bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool big_endian_;
  std::string file_;
};

bool is_corner_list(const Property& property) noexcept {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

/// Copies the geometry out of a body: the coordinates of the vertices, the corners of the faces.
class Copier {
 public:
  Copier(const Header& header, Body& body) : header_(header), body_(body) {}

  Screened copy() {
    find_layout();
    for (const Element& element : header_.elements) {
      body_.place = std::string(element.name);
      if (element.properties.empty()) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        body_.begin_instance();
        if (&element == vertex_) {
          copy_vertex();
        } else if (&element == face_) {
          copy_face();
        } else {
          for (const Property& property : element.properties) skip(property);
        }
        body_.end_instance();
      }
    }
    finish();
    return std::move(screened_);
  }

 private:
  bool is_text() const noexcept { return header_.encoding == Encoding::text; }

  void find_layout() {
    for (const Element& element : header_.elements) {
      const Element** role = element.name == "vertex" ? &vertex_
                             : element.name == "face" ? &face_
                                                      : nullptr;
      if (element.name == "tristrips" && element.count > 0) {
        body_.fail("triangle strips are not read; export the mesh as triangles");
      }
      if (role == nullptr) continue;
      if (*role != nullptr) body_.fail("declares its " + std::string(element.name) + " twice");
      *role = &element;
    }
    if (vertex_ == nullptr) body_.fail("has no vertices; check the export");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view name = std::string_view("xyz").substr(axis, 1);
      for (const Property& p : vertex_->properties) {
        if (p.name == name && p.count_type == nullptr) coordinates_[axis] = &p;
      }
      if (coordinates_[axis] == nullptr) {
        body_.fail("its vertices have no " + std::string(name) + "; check the export");
      }
    }
    if (face_ == nullptr || face_->count == 0) return;
    for (const Property& p : face_->properties) {
      if (is_corner_list(p) && p.count_type != nullptr && p.type->whole) corners_ = &p;
    }
    if (corners_ == nullptr) body_.fail("its faces have no list of vertex_indices");
  }

  void skip(const Property& property) {
    // The values of other properties are no concern of ours, however odd; only their room is.
    const std::uint64_t count =
        property.count_type == nullptr ? 1 : body_.take_whole(*property.count_type);
    for (std::uint64_t i = 0; i < count; ++i) body_.take(*property.type);
  }

  void copy_vertex() {
    std::array<std::string_view, 3> values;
    for (const Property& property : vertex_->properties) {
      const auto axis = std::find(coordinates_.begin(), coordinates_.end(), &property);
      if (axis == coordinates_.end()) {
        skip(property);
      } else {
        values[static_cast<std::size_t>(axis - coordinates_.begin())] = body_.take(*property.type);
      }
    }
    for (const std::string_view value : values) append(vertices_, value);
    end_line(vertices_);
  }

  void copy_face() {
    for (const Property& property : face_->properties) {
      if (&property != corners_) {
        skip(property);
        continue;
      }
      const std::uint64_t count = body_.take_whole(*property.count_type);
      // In text and bytes alike, the list is copied value by value, after its length.
      const std::size_t before = faces_.size();
      append_whole(faces_, count, *property.count_type);
      for (std::uint64_t c = 0; c < count; ++c) {
        const std::uint64_t vertex = body_.take_whole(*property.type);
        if (vertex >= vertex_->count) {
          body_.fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
                     std::to_string(vertex_->count) + "; the file is damaged");
        }
        append_whole(faces_, vertex, *property.type);
      }
      end_line(faces_);
      if (count < 3) {
        faces_.resize(before);
        ++dropped_;
      } else {
        ++screened_.faces;
        screened_.triangles += count - 2;
      }
    }
  }

  void append(std::string& to, std::string_view value) const {
    to += value;
    if (is_text()) to += ' ';
  }

  void append_whole(std::string& to, std::uint64_t value, const ScalarType& type) const {
    if (is_text()) {
      append(to, std::to_string(value));
      return;
    }
    for (std::size_t i = 0; i < type.size; ++i) {
      const std::size_t significance =
          header_.encoding == Encoding::big_endian ? type.size - 1 - i : i;
      to += static_cast<char>(static_cast<unsigned char>(value >> (8 * significance)));
    }
  }

  void end_line(std::string& to) const {
    if (is_text()) to += '\n';
  }

  void finish() {
    if (!body_.at_end()) {
      screened_.warnings.push_back("there is more in the file than its header declares: left out");
    }
    if (dropped_ > 0) {
      screened_.warnings.push_back("left out " + std::to_string(dropped_) +
                                   " faces with fewer than three corners");
    }
    screened_.vertices = vertex_->count;
    std::string& text = screened_.text;
    text = "ply\nformat ";
    text += is_text()                                  ? "ascii"
            : header_.encoding == Encoding::big_endian ? "binary_big_endian"
                                                       : "binary_little_endian";
    text += " 1.0\nelement vertex " + std::to_string(vertex_->count) + "\n";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Assimp sums the digits of a text in the declared type: doubles are rounded but once.
      text += "property ";
      text += is_text() ? std::string_view("double") : coordinates_[axis]->type->name;
      text += std::string(" ") + "xyz"[axis] + "\n";
    }
    if (corners_ != nullptr) {
      text += "element face " + std::to_string(screened_.faces) + "\nproperty list ";
      text += corners_->count_type->name;
      text += " ";
      text += corners_->type->name;
      text += " vertex_indices\n";
    }
    // Assimp takes a line feed off the front of a binary body, be it one or a byte of a number:
    // the second half of this line end is there to be taken.
    text += is_text() ? "end_header\n" : "end_header\r\n";
    text.reserve(text.size() + vertices_.size() + faces_.size());
    text += vertices_;
    text += faces_;
  }

  const Header& header_;
  Body& body_;
  const Element* vertex_ = nullptr;
  const Element* face_ = nullptr;
  std::array<const Property*, 3> coordinates_{};
  const Property* corners_ = nullptr;
  std::string vertices_, faces_;
  std::uint64_t dropped_ = 0;
  Screened screened_;
};

}  // namespace

Screened screen_ply(std::string_view contents, const std::string& file) {
  TextLines lines(contents, file);
  const Header header = parse_header(lines, contents.size());
  if (header.encoding == Encoding::text) {
    TextBody body(lines);
    return Copier(header, body).copy();
  }
  BinaryBody body(contents.substr(lines.position()), header.encoding == Encoding::big_endian, file);
  return Copier(header, body).copy();
}

}  // namespace keepout
