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

/// The places of the faults that MeshFindings counts, by kind.
struct MeshFaultPlaces {
  FaultPlaces boundary_edges = {};        // a group is a hole or a rim
  FaultPlaces non_manifold_edges = {};    // each place has two corners
  FaultPlaces inconsistent_edges = {};    // each place has two corners
  FaultPlaces pinched_vertices = {};      // each place has one corner
  FaultPlaces degenerate_triangles = {};  // both kinds; each place has three corners
  FaultPlaces duplicate_triangles = {};   // three corners
};

/// The findings of examine(). Each edge counts once, with any number of triangles. Triangles that
/// name a vertex twice are segments: they count only as degenerate, and have no edges.
struct MeshFindings {
  std::size_t vertices = 0;         // those that a triangle uses
  std::size_t unused_vertices = 0;  // 0 after a weld
  std::size_t triangles = 0;        // all of them

  std::size_t edges = 0;               // all of them
  std::size_t boundary_edges = 0;      // one triangle: a hole, or a rim
  std::size_t non_manifold_edges = 0;  // three triangles or more
  std::size_t inconsistent_edges = 0;  // two triangles, wound against each other
  std::size_t pinched_vertices = 0;    // several fans of triangles share only this vertex

  std::size_t repeated_vertex_triangles = 0;  // name a vertex twice
  std::size_t collinear_triangles = 0;        // three vertices on one line, exactly
  std::size_t duplicate_triangles = 0;        // same three vertices as an earlier one, any winding

  std::size_t components = 0;       // connected by shared vertices
  std::size_t edge_components = 0;  // connected by shared edges

  Box bounds{Vec3::Zero(), Vec3::Zero()};  // of the triangles [length]
  double area = 0.0;                       // [length^2]
  double signed_volume = 0.0;  // below 0: inside out; meaningless unless closed [length^3]

  /// V - E + F, over the triangles that have edges.
  std::ptrdiff_t euler_characteristic = 0;
  /// The number of handles of all components. Only for a watertight mesh without pinched vertices.
  std::optional<std::ptrdiff_t> genus;

  MeshFaultPlaces places = {};  // at most `most_places` of each kind: see examine()

  /// Returns the number of triangles without an area, of either kind.
  std::size_t degenerate_triangles() const noexcept {
    return repeated_vertex_triangles + collinear_triangles;
  }

  /// Returns true if there is no boundary: every edge has two triangles or more.
  bool is_closed() const noexcept { return edges > 0 && boundary_edges == 0; }

  /// Returns true if the mesh is closed, and each edge has exactly two triangles with consistent
  /// winding. Such a mesh has an inside and an outside.
  bool is_watertight() const noexcept {
    return is_closed() && non_manifold_edges == 0 && inconsistent_edges == 0;
  }

  /// Returns true if the mesh is watertight, but its normals point into the solid: the forbidden
  /// region and the free space are swapped.
  bool is_inside_out() const noexcept { return is_watertight() && signed_volume < 0.0; }

  /// Returns true if the extents are all below `meters_below`, too small for millimeters, but the
  /// mesh is not a point.
  bool looks_like_meters() const noexcept {
    const double extent = bounds.size().maxCoeff();
    return extent > 0.0 && extent < meters_below;
  }

  /// Returns true if an extent is above `micrometers_above`: too large for millimeters.
  bool looks_like_micrometers() const noexcept {
    return bounds.size().maxCoeff() > micrometers_above;
  }

  /// Returns looks_like_meters().
  [[deprecated("use looks_like_meters()")]] bool looks_like_metres() const noexcept {
    return looks_like_meters();
  }
  /// Returns looks_like_micrometers().
  [[deprecated("use looks_like_micrometers()")]] bool looks_like_micrometres() const noexcept {
    return looks_like_micrometers();
  }

  /// Anatomy that a tool must avoid is at least this large. [mm]
  static constexpr double meters_below = 3.0;
  /// Anatomy that a tool must avoid is at most this large. [mm]
  static constexpr double micrometers_above = 3000.0;
};

/// Examines a welded mesh, and repairs nothing. `most_places`: the most places that are reported of
/// each kind of fault. Takes about 0.2 s for a million triangles, and time linear in the size of
/// the mesh.
MeshFindings examine(const Mesh& mesh, std::size_t most_places = 10);

/// Reports if a mesh has two kinds of faulty edges that matter for a constraint; see MeshFindings.
struct EdgeFaults {
  bool boundary = false;      // an edge has one triangle: the surface is open
  bool inconsistent = false;  // an edge has two triangles, wound against each other
};

/// Returns the edge faults that examine() would find, with an error probability of 2^-64. If such
/// edges are few, it takes a thirtieth of the time of examine(): about 5 ms for a million triangles
/// on one processor. `threads`: the number of threads; 0: as many as there are processors.
EdgeFaults find_edge_faults(const Mesh& mesh, unsigned threads = 0);

/// A unit that the numbers of a file may be in.
struct UnitGuess {
  std::string_view unit;  // "m", "cm", "mm", "um", "in"
  double millimetres;     // length of the unit [mm]
};

/// Returns all units that a mesh file can be read in.
std::span<const UnitGuess> length_units() noexcept;

/// Returns the units other than millimeters in which a mesh of that largest extent has the size of
/// organs, 20 to 600 mm. Returns no unit if the extent is usual in millimeters: from 30 to
/// micrometers_above.
std::vector<UnitGuess> other_units(double extent);

/// Returns warnings, as sentences, for a size that is unusual for anatomy in mm, an open surface,
/// inconsistent winding, and a closed surface that faces inward. Empty if nothing is found.
/// `scale`: the factor by which the lengths of the file were multiplied.
std::vector<std::string> quick_check(const Mesh& mesh, unsigned threads = 0, double scale = 1.0);

/// Returns true if each edge has two triangles with consistent winding: the winding then defines
/// the free side everywhere. Ignores triangles that name a vertex twice. Takes about 0.1 s for a
/// million triangles.
bool is_watertight(const Mesh& mesh);

}  // namespace keepout
