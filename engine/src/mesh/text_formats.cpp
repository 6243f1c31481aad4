// SPDX-License-Identifier: BSD-3-Clause
// OBJ, OFF and text STL.
#include <algorithm>
#include <initializer_list>

#include "polygons.h"
#include "text_lines.h"

namespace keepout {
namespace {

using Words = std::span<const std::string_view>;

// OBJ

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) noexcept {
  return std::ranges::find(words, word) != words.end();
}

Vec3 read_obj_vertex(TextLines& lines) {
  const Words words = lines.words();
  // Five words have a weight. Six or more have a color.
  if (words.size() == 5 && lines.number<double>(words[4]) != 1.0) {
    lines.fail("weighted vertices are not read; export a plain mesh");
  }
  // All words must be numbers. A lost line end would otherwise hide the next vertex and shift the
  // numbers of the others.
  for (const std::string_view word : words.subspan(std::min<std::size_t>(words.size(), 4))) {
    lines.number<double>(word);
  }
  return lines.vertex(1);
}

/// Returns true for statements that do not change the surface.
bool is_harmless(std::string_view statement) noexcept {
  return is_one_of(statement,
                   {"vn", "vt", "usemtl", "s", "g", "o", "mtllib", "vp", "mg", "bevel", "lod",
                    "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj"});
}

void warn_of_unknown(std::uint64_t count, const std::string& first,
                     std::vector<std::string>& warnings) {
  if (count == 0) return;
  warnings.push_back(std::to_string(count) +
                     " lines that are no statements of OBJ are left out, the first in " + first +
                     ": if the file is damaged, part of the mesh is missing");
}

/// Returns the vertex of a corner such as 7, -1, 7/2, 7//3 or 7/2/3, counted from 0.
VertexId vertex_of(const TextLines& lines, std::string_view corner, std::uint64_t vertices) {
  std::string_view index = corner.substr(0, corner.find('/'));
  const bool from_the_end = index.starts_with('-');
  if (from_the_end) index.remove_prefix(1);
  const std::uint64_t given = lines.whole_number(index);
  if (given == 0 || given > vertices) {
    lines.fail("a face names vertex " + in_quotes(corner) + ", but there are " +
               std::to_string(vertices) + " so far; the file is damaged");
  }
  return static_cast<VertexId>(from_the_end ? vertices - given : given - 1);
}

// OFF

/// Returns the words after the keyword on its line. The keyword may be missing.
Words after_keyword(const TextLines& lines) {
  const Words words = lines.words();
  std::string_view keyword = words[0];
  if (keyword.find_first_not_of("0123456789") == std::string_view::npos) return words;
  for (const std::string_view prefix : {"ST", "C", "N"}) {  // more numbers after the coordinates
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  }
  if (keyword != "OFF") {
    lines.fail("expected 'OFF', found " + in_quotes(words[0]) +
               "; if the file has another format, give it that extension");
  }
  if (words.size() > 1 && words[1] == "BINARY") {
    lines.fail("binary OFF is not read; export it as text, or as STL or PLY");
  }
  return words.subspan(1);
}

void read_off_face(const TextLines& lines, std::uint64_t vertices, Polygons& polygons) {
  const Words words = lines.words();
  const std::uint64_t corners = lines.whole_number(words[0]);
  if (corners > words.size() - 1) {
    lines.fail("a face has fewer corners than it declares; the file is damaged");
  }
  for (const std::string_view word : words.subspan(1, static_cast<std::size_t>(corners))) {
    polygons.add_corner(lines.whole_number(word), vertices, lines);
  }
  polygons.end_polygon();
}

// STL

constexpr const char* no_endsolid =
    "the file ends without 'endsolid', so it was cut short; copy or export it again";

bool is_keyword(std::string_view word, std::string_view lower) noexcept {
  return std::ranges::equal(word, lower, [](char c, char l) {
    return c == l || (c >= 'A' && c <= 'Z' && c - 'A' + 'a' == l);
  });
}

/// The words of the text one after another. Line ends have no meaning within a solid.
class StlWords {
 public:
  explicit StlWords(TextLines& lines) : lines_(lines) {}

  /// Returns the next word without taking it; empty at the end of the text.
  std::string_view peek() {
    if (used_ == lines_.words().size()) {
      used_ = 0;
      if (!lines_.next()) return {};
    }
    return lines_.words()[used_];
  }

  std::string_view take() {
    const std::string_view word = peek();
    if (word.empty()) lines_.fail(no_endsolid);
    ++used_;
    return word;
  }

  std::string_view expect(std::string_view keyword) {
    const std::string_view word = take();
    if (!is_keyword(word, keyword)) {
      lines_.fail("expected '" + std::string(keyword) + "', found " + in_quotes(word) +
                  "; the file is damaged");
    }
    return word;
  }

  /// Returns the rest of the line after a keyword, which is the name of the solid.
  std::string name_after(std::string_view keyword) {
    const std::string_view word = expect(keyword);
    used_ = lines_.words().size();
    return std::string(lines_.after(word));
  }

 private:
  TextLines& lines_;
  std::size_t used_ = 0;
};

void read_facet(StlWords& words, TextLines& lines, Surface& surface) {
  words.expect("facet");
  words.expect("normal");
  // Normals are ignored, because files often have wrong ones, or NaN.
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

MeshFile read_obj(const MeshSource& source) {
  TextLines lines(source, {.comment = '#', .backslash_joins = true});
  MeshFile mesh;
  Polygons polygons;
  std::vector<Vec3>& vertices = mesh.surface.vertices;
  std::uint64_t left_out = 0;
  std::uint64_t unknown = 0;
  std::string first_unknown;
  while (lines.next()) {
    const std::string_view statement = lines.words()[0];
    const Words corners = lines.words().subspan(1);
    if (statement == "v") {
      vertices.push_back(read_obj_vertex(lines));
    } else if (is_one_of(statement, {"f", "fo"})) {
      if (corners.size() < 3) {
        lines.fail("a face needs three corners; the file is damaged, or was cut short");
      }
      for (const std::string_view corner : corners) {
        polygons.add_corner(vertex_of(lines, corner, vertices.size()));
      }
      polygons.end_polygon();
    } else if (is_one_of(statement, {"l", "p"})) {
      ++left_out;
    } else if (is_one_of(statement, {"cstype", "curv", "curv2", "surf", "bzp", "bsp", "cdp"})) {
      lines.fail("free-form curves and surfaces are not read; export a triangle mesh");
    } else if (is_one_of(statement, {"call", "csh"})) {
      lines.fail("other files are not read; export the mesh as one file");
    } else if (!is_harmless(statement) && unknown++ == 0) {
      first_unknown = "line " + std::to_string(lines.line()) + ": " + in_quotes(statement);
    }
  }
  if (vertices.empty()) {
    lines.fail("no vertices and no faces, so this is hardly an OBJ file; check its extension");
  }
  if (lines.has_only_floats()) mesh.round_to_floats();
  polygons.cut_into(mesh, source);
  mesh.comments = lines.take_comments();
  if (left_out > 0) {
    mesh.warnings.push_back(std::to_string(left_out) + " lines or points are left out");
  }
  warn_of_unknown(unknown, first_unknown, mesh.warnings);
  lines.warn_of_open_end("part of the mesh is missing, and OBJ has no counts to tell by",
                         mesh.warnings);
  return mesh;
}

MeshFile read_off(const MeshSource& source) {
  TextLines lines(source, {.comment = '#'});
  const auto advance = [&](const char* what) {
    if (lines.next()) return;
    lines.fail(std::string("the file ends before ") + what +
               ", so it was cut short; copy or export it again");
  };
  advance("its header");
  Words counts = after_keyword(lines);
  if (counts.empty()) {
    advance("its counts");
    counts = lines.words();
  }
  if (counts.size() < 2) lines.fail("expected the numbers of vertices and faces");
  const std::uint64_t vertices = lines.whole_number(counts[0]);
  const std::uint64_t faces = lines.whole_number(counts[1]);

  MeshFile mesh;
  for (std::uint64_t v = 0; v < vertices; ++v) {
    advance("its last vertex");
    mesh.surface.vertices.push_back(lines.vertex(0));
  }
  Polygons polygons;
  for (std::uint64_t f = 0; f < faces; ++f) {
    advance("its last face");
    read_off_face(lines, vertices, polygons);
  }
  if (lines.has_only_floats()) mesh.round_to_floats();
  polygons.cut_into(mesh, source);
  if (lines.next()) {
    mesh.warnings.push_back("there is more in the file than its header declares, from line " +
                            std::to_string(lines.line()) + " on: left out");
  }
  while (lines.next()) continue;  // reads their comments
  lines.warn_of_open_end(last_number_lost, mesh.warnings);
  mesh.comments = lines.take_comments();
  return mesh;
}

MeshFile read_text_stl(const MeshSource& source) {
  TextLines lines(source);
  StlWords words(lines);
  MeshFile mesh;
  do {
    mesh.comments.push_back(words.name_after("solid"));
    while (!is_keyword(words.peek(), "endsolid")) {
      if (words.peek().empty()) lines.fail(no_endsolid);
      read_facet(words, lines, mesh.surface);
    }
    mesh.comments.push_back(words.name_after("endsolid"));
  } while (!words.peek().empty());
  if (lines.has_only_floats()) mesh.round_to_floats();
  Polygons().cut_into(mesh, source);
  return mesh;
}

}  // namespace keepout
