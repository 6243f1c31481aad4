// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/doctor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "half_edges.h"
#include "keepout/geometry/orientation.h"

namespace keepout {

namespace {

/// Sets of numbers that grow together (union-find, with path halving).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  std::size_t find(std::size_t i) noexcept {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::size_t a, std::size_t b) noexcept {
    const auto [low, high] = std::minmax({find(a), find(b)});
    parent_[high] = low;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Corner i of triangle t, as one number.
constexpr std::size_t corner_number(TriangleId t, int i) noexcept {
  return 3 * std::size_t{t} + static_cast<std::size_t>(i);
}

void count_triangles(const Mesh& mesh, MeshFindings& findings) {
  std::vector<Corners> sorted(mesh.triangles().begin(), mesh.triangles().end());
  for (Corners& corners : sorted) std::sort(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  const auto kept = std::unique(sorted.begin(), sorted.end());
  findings.triangles = mesh.triangle_count();
  findings.duplicate_triangles = static_cast<std::size_t>(sorted.end() - kept);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    if (repeats_a_vertex(mesh.corners(t))) {
      ++findings.repeated_vertex_triangles;
    } else if (axis_of_sight(mesh.triangle(t)) < 0) {
      ++findings.collinear_triangles;
    }
  }
}

void measure(const Mesh& mesh, MeshFindings& findings) {
  findings.bounds = mesh.bounds();
  // Volumes relative to the middle of the mesh, so that a distant origin costs no accuracy.
  const Vec3 origin = mesh.bounds().center();
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle corners = mesh.triangle(t);
    const Vec3 cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    findings.area += cross.norm() / 2.0;
    findings.signed_volume += (corners[0] - origin).dot(cross) / 6.0;
  }
}

/// Edges by kind; joins what each edge holds together.
void count_edges(const Mesh& mesh, MeshFindings& findings, DisjointSets& fans,
                 DisjointSets& patches) {
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    ++findings.edges;
    if (sides.size() == 1) ++findings.boundary_edges;
    if (sides.size() > 2) ++findings.non_manifold_edges;
    if (sides.size() == 2 && sides[0].upwards == sides[1].upwards) ++findings.inconsistent_edges;
    const auto corner_at = [](const HalfEdge& side, bool low) {
      return corner_number(side.triangle, side.upwards == low ? side.edge : (side.edge + 1) % 3);
    };
    for (const HalfEdge& side : sides.subspan(1)) {
      patches.join(side.triangle, sides[0].triangle);
      fans.join(corner_at(side, true), corner_at(sides[0], true));
      fans.join(corner_at(side, false), corner_at(sides[0], false));
    }
  });
}

/// Vertices, components, and the numbers that follow from them.
void count_parts(const Mesh& mesh, MeshFindings& findings, DisjointSets& fans,
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
    if (fans_at[v] > 1) ++findings.pinched_vertices;
    if (islands.find(v) == v) ++findings.components;
  }
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

MeshFindings examine(const Mesh& mesh) {
  MeshFindings findings;
  DisjointSets fans(3 * mesh.triangle_count());  // of corners, around their vertices
  DisjointSets patches(mesh.triangle_count());   // of triangles
  count_triangles(mesh, findings);
  measure(mesh, findings);
  count_edges(mesh, findings, fans, patches);
  count_parts(mesh, findings, fans, patches);
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
