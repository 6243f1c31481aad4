// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "screen.h"
#include "text_lines.h"

namespace keepout {
namespace {

using WordSpan = std::span<const std::string_view>;

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) noexcept {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Statements that make a surface which is not a mesh, and those without a bearing on the geometry.
constexpr std::array<std::string_view, 4> free_form{"cstype", "curv", "curv2", "surf"};
constexpr std::array<std::string_view, 2> lines_and_points{"l", "p"};

void screen_vertex(const TextLines& lines, std::string& text) {
  const WordSpan words = lines.words();
  if (words.size() < 4) lines.fail("a vertex needs three coordinates; the file is damaged");
  if (words.size() == 5) {  // a weight; with more numbers, they are a colour
    lines.expect_number(words[4]);
    double weight = 0.0;
    std::from_chars(words[4].data(), words[4].data() + words[4].size(), weight);
    if (weight != 1.0) lines.fail("weighted vertices are not read; export a plain mesh");
  }
  text += 'v';
  for (int axis = 1; axis <= 3; ++axis) {
    lines.expect_number(words[axis]);
    text += words[axis].starts_with('.') ? " 0" : " ";
    text += words[axis];
  }
  text += '\n';
}

/// The vertex that a corner such as 7, -1, 7/2, 7//3 or 7/2/3 names, counted from 1.
std::uint64_t vertex_of(const TextLines& lines, std::string_view corner, std::uint64_t vertices) {
  std::string_view index = corner.substr(0, corner.find('/'));
  const bool from_the_end = index.starts_with('-');
  if (from_the_end) index.remove_prefix(1);
  const std::uint64_t given = lines.whole_number(index);
  if (given == 0 || given > vertices) {
    lines.fail("a face names vertex " + quoted(corner) + ", but there are " +
               std::to_string(vertices) + " so far; the file is damaged");
  }
  return from_the_end ? vertices + 1 - given : given;
}

}  // namespace

Screened screen_obj(std::string_view contents, const std::string& file) {
  TextLines lines(contents, file, {.comment = '#', .backslash_joins = true});
  Screened screened;
  screened.text.reserve(contents.size() + 64);
  std::uint64_t vertices = 0;
  std::uint64_t dropped = 0;
  while (lines.next()) {
    const std::string_view statement = lines.words()[0];
    const WordSpan corners = lines.words().subspan(1);
    if (statement == "v") {
      screen_vertex(lines, screened.text);
      ++vertices;
    } else if (statement == "f" || statement == "fo") {
      if (corners.size() < 3) {
        lines.fail("a face needs three corners; the file is damaged, or was cut short");
      }
      screened.text += 'f';
      for (const std::string_view corner : corners) {
        screened.text += ' ';
        screened.text += std::to_string(vertex_of(lines, corner, vertices));
      }
      screened.text += '\n';
      screened.vertices += corners.size();
      screened.triangles += corners.size() - 2;
      ++screened.faces;
    } else if (is_one_of(statement, lines_and_points)) {
      ++dropped;
    } else if (is_one_of(statement, free_form)) {
      lines.fail("free-form curves and surfaces are not read; export a triangle mesh");
    }
  }
  if (screened.faces == 0 && vertices == 0) {
    lines.fail("no vertices and no faces, so this is hardly an OBJ file; check its extension");
  }
  if (dropped > 0) {
    screened.warnings.push_back("left out " + std::to_string(dropped) + " lines or points");
  }
  if (lines.ends_within_a_line()) {
    screened.warnings.push_back(
        "the last line has no line end: if the file was cut short, part of the mesh is missing, "
        "and OBJ has no counts to tell by");
  }
  return screened;
}

}  // namespace keepout
