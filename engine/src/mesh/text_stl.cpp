// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "polygons.h"
#include "text_lines.h"

namespace keepout {
namespace {

constexpr const char* cut_short =
    "the file ends without 'endsolid', so it was cut short; copy or export it again";

bool is_keyword(std::string_view word, std::string_view lower) noexcept {
  return std::ranges::equal(word, lower, [](char c, char l) {
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

  std::string_view expect(std::string_view keyword) {
    const std::string_view word = take();
    if (!is_keyword(word, keyword)) {
      lines_.fail("expected '" + std::string(keyword) + "', found " + quoted(word) +
                  "; the file is damaged");
    }
    return word;
  }

  /// The rest of the line behind a keyword, which names the solid.
  std::string name_after(std::string_view keyword) {
    const std::string_view word = expect(keyword);
    used_ = lines_.words().size();
    return std::string(lines_.after(word));
  }

 private:
  TextLines& lines_;
  std::size_t used_ = 0;
};

void read_facet(Words& words, TextLines& lines, Surface& surface) {
  words.expect("facet");
  words.expect("normal");
  // Normals are computed from the corners; files are full of wrong ones, and of nan.
  for (int i = 0; i < 3; ++i) words.take();
  words.expect("outer");
  words.expect("loop");
  const auto first = static_cast<VertexId>(surface.vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    words.expect("vertex");
    Vec3 vertex;
    for (double& x : vertex) x = lines.coordinate(words.take());
    surface.vertices.push_back(vertex);
  }
  if (is_keyword(words.peek(), "vertex")) {
    lines.fail("a facet has more than three corners; triangulate the mesh and export it again");
  }
  words.expect("endloop");
  words.expect("endfacet");
  surface.triangles.push_back({first, first + 1, first + 2});
}

}  // namespace

MeshFile read_text_stl(const MeshSource& source) {
  TextLines lines(source);
  Words words(lines);
  MeshFile mesh;
  do {
    mesh.comments.push_back(words.name_after("solid"));
    while (!is_keyword(words.peek(), "endsolid")) {
      if (words.peek().empty()) lines.fail(cut_short);
      read_facet(words, lines, mesh.surface);
    }
    mesh.comments.push_back(words.name_after("endsolid"));
  } while (!words.peek().empty());
  if (lines.has_only_floats()) mesh.round_to_floats();
  Polygons().cut_into(mesh, source);
  return mesh;
}

}  // namespace keepout
