// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <string>

#include "keepout/mesh/ply_header.h"
#include "screen.h"
#include "text_lines.h"

namespace keepout {
namespace {

/// The values of one instance of an element after the other.
class Body {
 public:
  explicit Body(TextLines& lines) : lines_(lines) {}

  void begin_instance(const std::string& element) {
    element_ = element;
    used_ = 0;
    if (!lines_.next()) {
      lines_.fail("the file ends before its last " + element_ + ", so it was cut short");
    }
  }
  std::string_view take_number() {
    const std::string_view word = take_word();
    lines_.expect_number(word);
    return word;
  }
  std::uint64_t take_whole() { return lines_.whole_number(take_word()); }
  void end_instance() {
    if (used_ != lines_.words().size()) {
      lines_.fail("more values than the header declares for a " + element_);
    }
  }
  [[noreturn]] void fail(const std::string& what) const { lines_.fail(what); }
  /// True if nothing follows.
  bool at_end() { return !lines_.next(); }

 private:
  std::string_view take_word() {
    if (used_ == lines_.words().size()) {
      lines_.fail("fewer values than the header declares for a " + element_ +
                  "; the file is damaged");
    }
    return lines_.words()[used_++];
  }

  TextLines& lines_;
  std::string element_;
  std::size_t used_ = 0;
};

/// Copies the geometry out of a body: the coordinates of the vertices, the corners of the faces.
class Copier {
 public:
  Copier(const PlyHeader& header, const PlyLayout& layout, Body& body)
      : header_(header), layout_(layout), body_(body) {}

  Screened copy() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        body_.begin_instance(element.name);
        if (&element == layout_.vertex) {
          copy_vertex();
        } else if (&element == layout_.face) {
          copy_face();
        } else {
          for (const PlyProperty& property : element.properties) skip(property);
        }
        body_.end_instance();
      }
    }
    finish();
    return std::move(screened_);
  }

 private:
  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.is_list() ? body_.take_whole() : 1;
    for (std::uint64_t i = 0; i < count; ++i) body_.take_number();
  }

  void copy_vertex() {
    std::array<std::string_view, 3> values;
    for (const PlyProperty& property : layout_.vertex->properties) {
      const auto axis =
          std::find(layout_.coordinates.begin(), layout_.coordinates.end(), &property);
      if (axis == layout_.coordinates.end()) {
        skip(property);
      } else {
        values[static_cast<std::size_t>(axis - layout_.coordinates.begin())] = body_.take_number();
      }
    }
    for (const std::string_view value : values) append(vertices_, value);
    vertices_ += '\n';
  }

  void copy_face() {
    for (const PlyProperty& property : layout_.face->properties) {
      if (&property == layout_.corners) {
        copy_corners();
      } else {
        skip(property);
      }
    }
  }

  void copy_corners() {
    const std::uint64_t count = body_.take_whole();
    const std::size_t before = faces_.size();
    append(faces_, std::to_string(count));
    for (std::uint64_t c = 0; c < count; ++c) {
      const std::uint64_t vertex = body_.take_whole();
      if (vertex >= layout_.vertex->count) {
        body_.fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
                   std::to_string(layout_.vertex->count) + "; the file is damaged");
      }
      append(faces_, std::to_string(vertex));
    }
    faces_ += '\n';
    if (count < 3) {
      faces_.resize(before);
      ++dropped_;
    } else {
      ++screened_.faces;
      screened_.triangles += count - 2;
    }
  }

  static void append(std::string& to, std::string_view value) {
    to += value;
    to += ' ';
  }

  void finish() {
    if (!body_.at_end()) {
      screened_.warnings.push_back("there is more in the file than its header declares: left out");
    }
    if (dropped_ > 0) {
      screened_.warnings.push_back("left out " + std::to_string(dropped_) +
                                   " faces with fewer than three corners");
    }
    screened_.vertices = layout_.vertex->count;
    std::string& text = screened_.text;
    // Assimp sums the digits up in the declared type: doubles are rounded but once.
    text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(screened_.vertices) +
           "\nproperty double x\nproperty double y\nproperty double z\n";
    if (layout_.corners != nullptr) {
      text += "element face " + std::to_string(screened_.faces) + "\nproperty list ";
      text += layout_.corners->count_type->name;
      text += " ";
      text += layout_.corners->type->name;
      text += " vertex_indices\n";
    }
    text += "end_header\n";
    text.reserve(text.size() + vertices_.size() + faces_.size());
    text += vertices_;
    text += faces_;
  }

  const PlyHeader& header_;
  const PlyLayout& layout_;
  Body& body_;
  std::string vertices_, faces_;
  std::uint64_t dropped_ = 0;
  Screened screened_;
};

}  // namespace

Screened screen_ply(std::string_view contents, const std::string& file) {
  const PlyHeader header = read_ply_header(contents, file);
  const PlyLayout layout = find_ply_layout(header, file);
  TextLines lines(contents, file);
  while (lines.position() < header.size) lines.next();
  Body body(lines);
  return Copier(header, layout, body).copy();
}

}  // namespace keepout
