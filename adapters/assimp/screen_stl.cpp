// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <span>

#include "screen.h"
#include "text_lines.h"

namespace keepout {
namespace {

constexpr const char* cut_short =
    "the file ends without 'endsolid', so it was cut short; copy or export it again";

bool is_keyword(std::string_view word, std::string_view lower) noexcept {
  return word.size() == lower.size() &&
         std::equal(word.begin(), word.end(), lower.begin(), [](char c, char l) {
           return c == l || (c >= 'A' && c <= 'Z' && c - 'A' + 'a' == l);
         });
}

/// The words of the text one after the other, for line ends mean nothing between facets.
class Words {
 public:
  explicit Words(TextLines& lines) : lines_(lines) {}

  /// The next word, which stays the next; empty at the end of the text.
  std::string_view peek() {
    if (used_ == lines_.words().size()) {
      used_ = 0;
      if (!lines_.next()) return {};
    }
    return lines_.words()[used_];
  }

  std::string_view take() {
    const std::string_view word = peek();
    if (word.empty()) lines_.fail(cut_short);
    ++used_;
    return word;
  }

  void expect(std::string_view keyword) {
    const std::string_view word = take();
    if (!is_keyword(word, keyword)) {
      lines_.fail("expected '" + std::string(keyword) + "', found " + quoted(word) +
                  "; the file is damaged");
    }
  }

  void skip_line() { used_ = lines_.words().size(); }

 private:
  TextLines& lines_;
  std::size_t used_ = 0;
};

void screen_facet(Words& words, TextLines& lines, std::string& text) {
  words.expect("facet");
  words.expect("normal");
  // Normals are computed from the corners; files are full of wrong ones, and of nan.
  for (int i = 0; i < 3; ++i) words.take();
  words.expect("outer");
  words.expect("loop");
  text += "facet normal 0 0 0\n";
  for (int corner = 0; corner < 3; ++corner) {
    words.expect("vertex");
    text += "vertex";
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view number = words.take();
      lines.expect_number(number);
      text += ' ';
      text += number;
    }
    text += '\n';
  }
  if (is_keyword(words.peek(), "vertex")) {
    lines.fail("a facet has more than three corners; triangulate the mesh and export it again");
  }
  words.expect("endloop");
  words.expect("endfacet");
}

}  // namespace

Screened screen_stl(std::string_view contents, const std::string& file) {
  TextLines lines(contents, file);
  Words words(lines);
  Screened screened;
  screened.text.reserve(contents.size());
  screened.text = "solid\n";
  do {
    words.expect("solid");
    words.skip_line();  // the name
    while (!is_keyword(words.peek(), "endsolid")) {
      if (words.peek().empty()) lines.fail(cut_short);
      screen_facet(words, lines, screened.text);
      ++screened.faces;
    }
    words.skip_line();
  } while (!words.peek().empty());
  screened.text += "endsolid\n";
  screened.vertices = 3 * screened.faces;
  screened.triangles = screened.faces;
  return screened;
}

}  // namespace keepout
