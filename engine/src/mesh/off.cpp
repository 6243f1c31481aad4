// SPDX-License-Identifier: BSD-3-Clause
#include "polygons.h"
#include "text_lines.h"

namespace keepout {
namespace {

using Words = std::span<const std::string_view>;

/// Takes the keyword, which may be missing, and leaves the words after it on its line.
Words after_keyword(const TextLines& lines) {
  const Words words = lines.words();
  std::string_view keyword = words[0];
  if (keyword.find_first_not_of("0123456789") == std::string_view::npos) return words;
  for (const std::string_view prefix : {"ST", "C", "N"}) {  // more numbers after the coordinates
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  }
  if (keyword != "OFF") {
    lines.fail("expected 'OFF', found " + quoted(words[0]) +
               "; if the file has another format, give it that extension");
  }
  if (words.size() > 1 && words[1] == "BINARY") {
    lines.fail("binary OFF is not read; export it as text, or as STL or PLY");
  }
  return words.subspan(1);
}

void read_face(const TextLines& lines, std::uint64_t vertices, Polygons& polygons) {
  const Words words = lines.words();
  const std::uint64_t corners = lines.whole_number(words[0]);
  if (corners > words.size() - 1) {
    lines.fail("a face has fewer corners than it declares; the file is damaged");
  }
  for (const std::string_view word : words.subspan(1, corners)) {
    polygons.add_corner(lines.whole_number(word), vertices, lines);
  }
  polygons.end_polygon();
}

}  // namespace

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
    read_face(lines, vertices, polygons);
  }
  if (lines.has_only_floats()) mesh.round_to_floats();
  polygons.cut_into(mesh, source);
  if (lines.next()) {
    mesh.warnings.push_back("there is more in the file than its header declares, from line " +
                            std::to_string(lines.line()) + " on: left out");
  }
  while (lines.next()) continue;  // for their comments
  mesh.comments = lines.take_comments();
  return mesh;
}

}  // namespace keepout
