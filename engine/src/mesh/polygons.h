// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "keepout/ids.h"
#include "mesh_file.h"

namespace keepout {

/// The faces of a file as it has them, until all its vertices are known and they can be cut into
/// triangles.
class Polygons {
 public:
  /// The next corner of a polygon.
  void add_corner(VertexId vertex) { corners_.push_back(vertex); }
  /// The same as a file has it, one of `vertices`, which are numbered from `first` on in the mesh.
  /// If it is none, `place` fails.
  template <class Place>
  void add_corner(std::uint64_t vertex, std::uint64_t vertices, std::uint64_t first,
                  const Place& place) {
    if (vertex >= vertices) {
      place.fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
                 std::to_string(vertices) + "; the file is damaged");
    }
    add_corner(static_cast<VertexId>(first + vertex));
  }
  /// Like above, where the first vertex of the mesh is number 0 of the file.
  template <class Place>
  void add_corner(std::uint64_t vertex, std::uint64_t vertices, const Place& place) {
    add_corner(vertex, vertices, 0, place);
  }

  /// Ends a polygon. One of fewer than three corners is left out.
  void end_polygon();

  /// Cuts each polygon into two triangles less than it has corners, wound as it is, and appends
  /// them to the surface: a fan where it is convex, else ears (Meisters 1975), as seen along its
  /// mean normal. A corner that equals the next one gets a degenerate triangle. What crosses itself
  /// or has no area is cut somehow. Warns of what was left out.
  ///
  /// Throws Error if the surface then has no triangles, if it has too many to be numbered, and for
  /// a polygon that is not convex and has more than 1000 corners, as ears take a time that grows
  /// with the third power of the corners.
  void cut_into(MeshFile& mesh, const MeshSource& source) const;

 private:
  std::vector<VertexId> corners_;  // one polygon after the other
  std::vector<std::size_t> ends_;  // of each in them
  std::size_t left_out_ = 0;
};

}  // namespace keepout
