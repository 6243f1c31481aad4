// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/diagnostics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "disjoint_sets.h"
#include "fault_list.h"
#include "half_edges.h"
#include "keepout/geometry/orientation.h"

namespace keepout {

namespace {

/// All faults, by kind.
struct Faults {
  FaultList boundary_edges{2};
  FaultList non_manifold_edges{2};
  FaultList inconsistent_edges{2};
  FaultList pinched_vertices{1};
  FaultList degenerate_triangles{3};
  FaultList duplicate_triangles{3};
};

/// Returns the number of corner i of triangle t.
constexpr std::size_t corner_number(TriangleId t, int i) noexcept {
  return 3 * std::size_t{t} + static_cast<std::size_t>(i);
}

void count_triangles(const Mesh& mesh, MeshFindings& findings, Faults& faults) {
  std::vector<Corners> sorted(mesh.triangles().begin(), mesh.triangles().end());
  for (Corners& corners : sorted) std::sort(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const Corners& c = sorted[i];
    if (c == sorted[i - 1]) faults.duplicate_triangles.add({c[0], c[1], c[2]});
  }
  findings.triangles = mesh.triangle_count();
  findings.duplicate_triangles = faults.duplicate_triangles.size();
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Corners& c = mesh.corners(t);
    if (repeats_a_vertex(c)) {
      ++findings.repeated_vertex_triangles;
    } else if (axis_of_sight(mesh.triangle(t)) < 0) {
      ++findings.collinear_triangles;
    } else {
      continue;
    }
    faults.degenerate_triangles.add({c[0], c[1], c[2]});
  }
}

void measure(const Mesh& mesh, MeshFindings& findings) {
  findings.bounds = mesh.bounds();
  // Volumes are relative to the middle of the mesh, so that a distant origin costs no accuracy.
  const Vec3 origin = mesh.bounds().center();
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle corners = mesh.triangle(t);
    const Vec3 cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    findings.area += cross.norm() / 2.0;
    findings.signed_volume += (corners[0] - origin).dot(cross) / 6.0;
  }
}

/// Counts edges by kind, and joins the triangles and corners that each edge connects.
void count_edges(const Mesh& mesh, MeshFindings& findings, Faults& faults, DisjointSets& fans,
                 DisjointSets& patches) {
  for_each_edge(mesh, [&](VertexId lower, std::span<const HalfEdge> sides) {
    ++findings.edges;
    const VertexId higher = sides[0].high;
    if (sides.size() == 1) faults.boundary_edges.add({lower, higher});
    if (sides.size() > 2) faults.non_manifold_edges.add({lower, higher});
    if (sides.size() == 2 && sides[0].upwards == sides[1].upwards) {
      faults.inconsistent_edges.add({lower, higher});
    }
    const auto corner_at = [](const HalfEdge& side, bool low) {
      return corner_number(side.triangle, side.upwards == low ? side.edge : (side.edge + 1) % 3);
    };
    for (const HalfEdge& side : sides.subspan(1)) {
      patches.join(side.triangle, sides[0].triangle);
      fans.join(corner_at(side, true), corner_at(sides[0], true));
      fans.join(corner_at(side, false), corner_at(sides[0], false));
    }
  });
  findings.boundary_edges = faults.boundary_edges.size();
  findings.non_manifold_edges = faults.non_manifold_edges.size();
  findings.inconsistent_edges = faults.inconsistent_edges.size();
}

/// Counts vertices and components, and computes the numbers that follow from them.
void count_parts(const Mesh& mesh, MeshFindings& findings, Faults& faults, DisjointSets& fans,
                 DisjointSets& patches) {
  DisjointSets islands(mesh.vertex_count());
  std::vector<bool> used(mesh.vertex_count(), false);
  std::vector<std::size_t> fans_at(mesh.vertex_count(), 0);
  std::size_t faces = 0;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Corners& corners = mesh.corners(t);
    for (const VertexId v : corners) used[v] = true;
    if (repeats_a_vertex(corners)) continue;
    ++faces;
    if (patches.find(t) == t) ++findings.edge_components;
    islands.join(corners[0], corners[1]);
    islands.join(corners[0], corners[2]);
    for (int i = 0; i < 3; ++i) {
      if (fans.find(corner_number(t, i)) == corner_number(t, i)) ++fans_at[corners[i]];
    }
  }
  std::size_t surface_vertices = 0;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (used[v]) ++findings.vertices;
    if (fans_at[v] == 0) continue;
    ++surface_vertices;
    if (fans_at[v] > 1) faults.pinched_vertices.add({v});
    if (islands.find(v) == v) ++findings.components;
  }
  findings.pinched_vertices = faults.pinched_vertices.size();
  findings.unused_vertices = mesh.vertex_count() - findings.vertices;
  findings.euler_characteristic = static_cast<std::ptrdiff_t>(surface_vertices) -
                                  static_cast<std::ptrdiff_t>(findings.edges) +
                                  static_cast<std::ptrdiff_t>(faces);
  if (findings.is_watertight() && findings.pinched_vertices == 0) {
    findings.genus =
        static_cast<std::ptrdiff_t>(findings.components) - findings.euler_characteristic / 2;
  }
}

}  // namespace

MeshFindings examine(const Mesh& mesh, std::size_t most_places) {
  MeshFindings findings;
  Faults faults;
  DisjointSets fans(3 * mesh.triangle_count());  // of corners, around their vertices
  DisjointSets patches(mesh.triangle_count());   // of triangles
  count_triangles(mesh, findings, faults);
  measure(mesh, findings);
  count_edges(mesh, findings, faults, fans, patches);
  count_parts(mesh, findings, faults, fans, patches);
  const auto places = [&](const FaultList& list) { return list.places(mesh, most_places); };
  findings.places = {.boundary_edges = places(faults.boundary_edges),
                     .non_manifold_edges = places(faults.non_manifold_edges),
                     .inconsistent_edges = places(faults.inconsistent_edges),
                     .pinched_vertices = places(faults.pinched_vertices),
                     .degenerate_triangles = places(faults.degenerate_triangles),
                     .duplicate_triangles = places(faults.duplicate_triangles)};
  return findings;
}

bool is_watertight(const Mesh& mesh) {
  bool has_edges = false;
  bool all_paired = true;
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    has_edges = true;
    all_paired = all_paired && sides.size() == 2 && sides[0].upwards != sides[1].upwards;
  });
  return has_edges && all_paired;
}

}  // namespace keepout
