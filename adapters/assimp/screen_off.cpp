// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include <span>

#include "screen.h"
#include "text_lines.h"

namespace keepout {
namespace {

using WordSpan = std::span<const std::string_view>;

constexpr std::uint64_t most_corners = 9;  // assimp drops larger faces

/// Takes the keyword, which may be missing, and leaves the words after it on its line.
WordSpan after_keyword(const TextLines& lines) {
  WordSpan words = lines.words();
  std::string_view keyword = words[0];
  if (keyword.find_first_not_of("0123456789") == std::string_view::npos) return words;
  for (const std::string_view prefix : {"ST", "C", "N"}) {  // more numbers after the coordinates
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  }
  if (keyword != "OFF") {
    lines.fail("expected 'OFF', found " + quoted(words[0]) +
               "; if the file has another format, give it that extension");
  }
  words = words.subspan(1);
  if (!words.empty() && words[0] == "BINARY") {
    lines.fail("binary OFF is not read; export it as text, or as STL or PLY");
  }
  return words;
}

}  // namespace

Screened screen_off(std::string_view contents, const std::string& file) {
  TextLines lines(contents, file, {.comment = '#'});
  const auto advance = [&](const char* what) {
    if (lines.next()) return;
    lines.fail(std::string("the file ends before ") + what +
               ", so it was cut short; copy or export it again");
  };

  advance("its header");
  WordSpan counts = after_keyword(lines);
  if (counts.empty()) {
    advance("its counts");
    counts = lines.words();
  }
  if (counts.size() < 2) lines.fail("expected the numbers of vertices and faces");
  const std::uint64_t vertices = lines.whole_number(counts[0]);
  const std::uint64_t faces = lines.whole_number(counts[1]);

  Screened screened;
  std::string& text = screened.text;
  text.reserve(contents.size() + 64);
  std::string body;
  body.reserve(contents.size());
  for (std::uint64_t v = 0; v < vertices; ++v) {
    advance("its last vertex");
    const WordSpan words = lines.words();
    if (words.size() < 3) lines.fail("a vertex needs three coordinates; the file is damaged");
    for (int axis = 0; axis < 3; ++axis) {
      lines.expect_number(words[axis]);
      body += words[axis];
      body += axis < 2 ? ' ' : '\n';
    }
  }
  std::uint64_t dropped = 0;
  for (std::uint64_t f = 0; f < faces; ++f) {
    advance("its last face");
    const WordSpan words = lines.words();
    const std::uint64_t corners = lines.whole_number(words[0]);
    if (corners > words.size() - 1) {
      lines.fail("a face has fewer corners than it declares; the file is damaged");
    }
    for (std::uint64_t c = 1; c <= corners; ++c) {
      if (lines.whole_number(words[c]) >= vertices) {
        lines.fail("a face names vertex " + std::string(words[c]) + ", but there are only " +
                   std::to_string(vertices) + "; the file is damaged");
      }
    }
    if (corners > most_corners) {
      lines.fail("a face has " + std::to_string(corners) +
                 " corners, and up to 9 can be read; triangulate the mesh and export it again");
    }
    if (corners < 3) {
      ++dropped;
      continue;
    }
    for (std::uint64_t c = 0; c <= corners; ++c) {
      body += words[c];
      body += c < corners ? ' ' : '\n';
    }
    ++screened.faces;
    screened.triangles += corners - 2;
  }
  if (dropped > 0) {
    screened.warnings.push_back("left out " + std::to_string(dropped) +
                                " faces with fewer than three corners");
  }
  if (lines.next()) {
    screened.warnings.push_back("there is more in the file than its header declares, from line " +
                                std::to_string(lines.line()) + " on: left out");
  }
  screened.vertices = vertices;
  text += "OFF\n" + std::to_string(vertices) + " " + std::to_string(screened.faces) + " 0\n";
  text += body;
  return screened;
}

}  // namespace keepout
