// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <initializer_list>

#include "polygons.h"
#include "text_lines.h"

namespace keepout {
namespace {

using Words = std::span<const std::string_view>;

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) noexcept {
  return std::ranges::find(words, word) != words.end();
}

Vec3 read_vertex(TextLines& lines) {
  const Words words = lines.words();
  // A weight; with more numbers, they are a colour.
  if (words.size() == 5 && lines.number<double>(words[4]) != 1.0) {
    lines.fail("weighted vertices are not read; export a plain mesh");
  }
  return lines.vertex(1);
}

/// The vertex that a corner such as 7, -1, 7/2, 7//3 or 7/2/3 names, counted from 0.
VertexId vertex_of(const TextLines& lines, std::string_view corner, std::uint64_t vertices) {
  std::string_view index = corner.substr(0, corner.find('/'));
  const bool from_the_end = index.starts_with('-');
  if (from_the_end) index.remove_prefix(1);
  const std::uint64_t given = lines.whole_number(index);
  if (given == 0 || given > vertices) {
    lines.fail("a face names vertex " + quoted(corner) + ", but there are " +
               std::to_string(vertices) + " so far; the file is damaged");
  }
  return static_cast<VertexId>(from_the_end ? vertices - given : given - 1);
}

}  // namespace

MeshFile read_obj(const MeshSource& source) {
  TextLines lines(source, {.comment = '#', .backslash_joins = true});
  MeshFile mesh;
  Polygons polygons;
  std::vector<Vec3>& vertices = mesh.surface.vertices;
  std::uint64_t left_out = 0;
  while (lines.next()) {
    const std::string_view statement = lines.words()[0];
    const Words corners = lines.words().subspan(1);
    if (statement == "v") {
      vertices.push_back(read_vertex(lines));
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
    } else if (is_one_of(statement, {"cstype", "curv", "curv2", "surf"})) {
      lines.fail("free-form curves and surfaces are not read; export a triangle mesh");
    }
  }
  if (vertices.empty()) {
    lines.fail("no vertices and no faces, so this is hardly an OBJ file; check its extension");
  }
  if (lines.has_only_floats()) mesh.round_to_floats();
  polygons.cut_into(mesh, source);
  mesh.comments = lines.take_comments();
  if (left_out > 0) {
    mesh.warnings.push_back("left out " + std::to_string(left_out) + " lines or points");
  }
  if (lines.ends_within_a_line()) {
    mesh.warnings.push_back(
        "the last line has no line end: if the file was cut short, part of the mesh is missing, "
        "and OBJ has no counts to tell by");
  }
  return mesh;
}

}  // namespace keepout
