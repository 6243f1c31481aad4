// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/mesh/fault_places.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Where the faults that MeshFindings counts are, by kind.
struct MeshFaultPlaces {
  FaultPlaces boundary_edges = {};        // a group is a hole, or a rim
  FaultPlaces non_manifold_edges = {};    // each place has two corners
  FaultPlaces inconsistent_edges = {};    // the same
  FaultPlaces pinched_vertices = {};      // each place has one corner
  FaultPlaces degenerate_triangles = {};  // of either kind; three corners
  FaultPlaces duplicate_triangles = {};   // three corners
};

/// What there is to know about a mesh before it guards anything. Edges are counted once each,
/// however many triangles they have. Triangles that name a vertex twice are segments, with neither
/// edges nor a part in the surface: they are only counted as degenerate.
struct MeshFindings {
  std::size_t vertices = 0;         // those that a triangle uses
  std::size_t unused_vertices = 0;  // none after a weld
  std::size_t triangles = 0;        // all of them

  std::size_t edges = 0;               // all of them
  std::size_t boundary_edges = 0;      // one triangle: a hole, or a rim
  std::size_t non_manifold_edges = 0;  // three triangles or more
  std::size_t inconsistent_edges = 0;  // two triangles, wound against each other
  std::size_t pinched_vertices = 0;    // fans of triangles that only a point holds together

  std::size_t repeated_vertex_triangles = 0;  // name a vertex twice
  std::size_t collinear_triangles = 0;        // three vertices on one line, exactly
  std::size_t duplicate_triangles = 0;        // same three vertices as an earlier one, any winding

  std::size_t components = 0;       // held together by shared vertices
  std::size_t edge_components = 0;  // held together by shared edges

  Box bounds{Vec3::Zero(), Vec3::Zero()};  // of the triangles [length]
  double area = 0.0;                       // [length^2]
  double signed_volume = 0.0;  // below 0: inside out. Meaningless when not closed. [length^3]

  /// V - E + F, over the triangles that have edges.
  std::ptrdiff_t euler_characteristic = 0;
  /// Handles, in all components together. Only a watertight mesh without pinched vertices has one.
  std::optional<std::ptrdiff_t> genus;

  MeshFaultPlaces places = {};  // of each kind at most as many as examine() was asked for

  /// Those without an area, of either kind.
  std::size_t degenerate_triangles() const noexcept {
    return repeated_vertex_triangles + collinear_triangles;
  }

  /// No boundary: every edge has two triangles or more.
  bool is_closed() const noexcept { return edges > 0 && boundary_edges == 0; }

  /// Closed, with two triangles on every edge, wound alike: it has an inside and an outside.
  bool is_watertight() const noexcept {
    return is_closed() && non_manifold_edges == 0 && inconsistent_edges == 0;
  }

  /// Watertight, but its normals point into the solid: the forbidden region and the free space are
  /// swapped.
  bool is_inside_out() const noexcept { return is_watertight() && signed_volume < 0.0; }

  /// Smaller than `metres_below` in every direction, where files are in millimetres; but no point.
  bool looks_like_metres() const noexcept {
    const double extent = bounds.size().maxCoeff();
    return extent > 0.0 && extent < metres_below;
  }

  /// Larger than `micrometres_above` in some direction, where files are in millimetres.
  bool looks_like_micrometres() const noexcept {
    return bounds.size().maxCoeff() > micrometres_above;
  }

  /// No anatomy that a tool is kept out of is smaller. [mm]
  static constexpr double metres_below = 3.0;
  /// And none is larger. [mm]
  static constexpr double micrometres_above = 3000.0;
};

/// Examines a welded mesh: a pure report, nothing is repaired. `most_places`: at most so many
/// places of each kind of fault are reported. Time grows with the size of the mesh, some 0.2 s for
/// a million triangles.
MeshFindings examine(const Mesh& mesh, std::size_t most_places = 10);

/// Whether a mesh has edges of two kinds that a guard's user should know of. What doctor.h counts.
struct EdgeFaults {
  bool boundary = false;      // some edge has one triangle: the surface is open
  bool inconsistent = false;  // some edge has two triangles, wound against each other
};

/// As examine() would find, up to a chance of 2^-64; for a surface with few such edges in a
/// thirtieth of the time, some 5 ms for a million triangles and a processor. On `threads` threads
/// at once; 0: as many as there are processors.
EdgeFaults find_edge_faults(const Mesh& mesh, unsigned threads = 0);

/// A unit that the numbers of a file may be in.
struct UnitGuess {
  std::string_view unit;  // "m", "cm", "mm", "um", "in"
  double millimetres;     // that one is
};

/// All units that a mesh can be read in.
std::span<const UnitGuess> length_units() noexcept;

/// The units other than millimetres in which something of that largest extent would be of the size
/// that organs have, 20 to 600 mm. A size that is usual in millimetres has none: from 30 on.
std::vector<UnitGuess> other_units(double extent);

/// What a mesh should not guard anything without: a sentence each, for people, on a size that is
/// none of anatomy in millimetres, on an open surface, on an inconsistent winding, and on a closed
/// surface that faces inward. Empty when there is nothing to say. `scale`: that the lengths of its
/// file were multiplied by.
std::vector<std::string> quick_check(const Mesh& mesh, unsigned threads = 0, double scale = 1.0);

/// Whether each edge has two triangles, wound alike: such a mesh has a free side everywhere, which
/// its winding tells. Segments, which name a vertex twice, are passed over. Time: some .1 s for a
/// million triangles.
bool is_watertight(const Mesh& mesh);

}  // namespace keepout
