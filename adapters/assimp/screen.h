// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace keepout {

/// The formats read through assimp; STL and PLY here are their text forms.
enum class MeshFormat { stl, ply, obj, off };

/// A file that was looked through before assimp gets to see it.
///
/// Assimp 5.2.5 goes on in silence after much that would leave a hole in a guarded surface. Debian
/// ships it with its assertions on, so other damage aborts the process: fed with small files that
/// had bytes changed or missing, it aborted for a third of the OFF files, and was busy for seconds
/// with a third of the PLY files. Found by reading and by test:
/// - PLY, text: a missing value becomes a zero. Strips keep one triangle.
/// - OFF: a missing or negative index becomes vertex 0; comments among the numbers are an error;
///   lines of 4096 characters overflow the stack.
/// - OBJ: the last line is dropped if it lacks its line end; "v .5 0 0" is no vertex, so all later
///   indices shift; "f 01 2 3" has four corners; materials reorder the triangles.
/// - STL: words that it does not know are skipped, "1.2.3" is two numbers.
/// - All: a number of 20 digits is 0. Triangulation does not check the indices, and asserts that
///   there are no faces of fewer than three corners.
///
/// So `text` is a copy with the geometry alone, plainly written and checked in every index and
/// count, and whatever assimp returns must agree with `vertices` and `faces`.
struct Screened {
  std::string text;
  std::size_t vertices = 0;   // that assimp must return
  std::size_t faces = 0;      // polygons that assimp must return, of three corners or more
  std::size_t triangles = 0;  // that the polygons must be cut into
  std::vector<std::string> warnings;
};

/// Throws Error, with the line where there are lines, for anything that is malformed, cut short, or
/// cannot be read faithfully. `file` names the file in errors.
Screened screen(MeshFormat format, std::string_view contents, const std::string& file);

Screened screen_stl(std::string_view contents, const std::string& file);
Screened screen_ply(std::string_view contents, const std::string& file);
Screened screen_obj(std::string_view contents, const std::string& file);
Screened screen_off(std::string_view contents, const std::string& file);

}  // namespace keepout
