// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "keepout/ids.h"
#include "mesh_file.h"

namespace keepout {

/// The faces of a file as they were read, until all vertices are known and the faces can be cut
/// into triangles.
class Polygons {
 public:
  /// Adds the next corner of a polygon.
  void add_corner(VertexId vertex) { corners_.push_back(vertex); }
  /// Adds a corner by its number in the file, below `vertices`. These vertices are numbered from
  /// `first` on in the mesh. Fails with place.fail() for a number that is out of range.
  template <class Place>
  void add_corner(std::uint64_t vertex, std::uint64_t vertices, std::uint64_t first,
                  const Place& place) {
    if (vertex >= vertices) {
      place.fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
                 std::to_string(vertices) + "; the file is damaged");
    }
    add_corner(static_cast<VertexId>(first + vertex));
  }
  /// Like above, for a file whose vertex 0 is the first vertex of the mesh.
  template <class Place>
  void add_corner(std::uint64_t vertex, std::uint64_t vertices, const Place& place) {
    add_corner(vertex, vertices, 0, place);
  }

  /// Ends a polygon. Drops a polygon with fewer than three corners.
  void end_polygon();

  /// Cuts each polygon with n corners into n - 2 triangles of the same winding, and appends them to
  /// the surface. Convex polygons are cut as fans, others by ear clipping (Meisters 1975), seen
  /// along their mean normal. A corner that equals the next one gets a degenerate triangle.
  /// Polygons that cross themselves or have no area are cut in an unspecified way. Warns of
  /// polygons that were left out.
  ///
  /// Throws Error if the surface then has no triangles, or too many. Throws Error for a polygon
  /// that is not convex and has more than 1000 corners, because the time of ear clipping grows with
  /// the third power of the corners.
  void cut_into(MeshFile& mesh, const MeshSource& source) const;

 private:
  std::vector<VertexId> corners_;  // one polygon after the other
  std::vector<std::size_t> ends_;  // the end of each polygon in corners_
  std::size_t left_out_ = 0;
};

}  // namespace keepout
