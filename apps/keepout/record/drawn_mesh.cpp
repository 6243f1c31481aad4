// SPDX-License-Identifier: BSD-3-Clause
#include "record/drawn_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "page/base64.h"
#include "page/gzip.h"
#include "page/packed_mesh.h"

namespace keepout::app {
namespace {

constexpr std::size_t most_triangles = 1'000'000;

double area(const Mesh& mesh) {
  double twice = 0.0;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle corners = mesh.triangle(t);
    twice += (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  }
  return 0.5 * twice;
}

/// Returns true if a triangle is in the region that keeps all detail.
bool is_close(const Mesh& mesh, const Corners& corners, const std::optional<Box>& closely) {
  return closely && std::ranges::all_of(corners, [&](VertexId v) {
           return distance_to(*closely, mesh.vertices()[v]) == 0.0;
         });
}

std::size_t close_triangles(const Mesh& mesh, const std::optional<Box>& closely) {
  return static_cast<std::size_t>(std::ranges::count_if(
      mesh.triangles(), [&](const Corners& corners) { return is_close(mesh, corners, closely); }));
}

/// Returns the remaining vertices, numbered by their first use, and the triangles that do not
/// collapse.
Surface with_cells(const Mesh& mesh, double cell, const std::optional<Box>& closely) {
  std::map<std::array<std::int64_t, 3>, VertexId> taken;  // of each cell: the remaining vertex
  std::vector<VertexId> stays(mesh.vertex_count());
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3& place = mesh.vertices()[v];
    const bool stays_put = closely && distance_to(*closely, place) == 0.0;
    const auto along = [&](int axis) { return std::llround(place[axis] / cell); };
    stays[v] = stays_put ? v : taken.try_emplace({along(0), along(1), along(2)}, v).first->second;
  }
  Surface surface;
  std::vector<std::optional<VertexId>> number(mesh.vertex_count());
  for (const Corners& corners : mesh.triangles()) {
    const Corners kept = {stays[corners[0]], stays[corners[1]], stays[corners[2]]};
    if (kept[0] == kept[1] || kept[1] == kept[2] || kept[2] == kept[0]) continue;
    Corners& drawn = surface.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      if (!number[kept[i]]) {
        number[kept[i]] = static_cast<VertexId>(surface.vertices.size());
        surface.vertices.push_back(mesh.vertices()[kept[i]]);
      }
      drawn[i] = *number[kept[i]];
    }
  }
  return surface;
}

}  // namespace

Surface coarsened(const Mesh& mesh, std::size_t most, const std::optional<Box>& closely) {
  // A cell of a flat grid has two triangles. The cells grow until few enough triangles are left.
  const std::size_t all = most + close_triangles(mesh, closely);
  double cell = std::sqrt(2.0 * area(mesh) / static_cast<double>(most));
  for (int tries = 0;; ++tries, cell *= 1.4) {
    Surface surface = with_cells(mesh, cell, closely);
    if (surface.triangles.size() <= all || tries == 20) return surface;
  }
}

Json drawn_mesh(const std::string& name, const Mesh& mesh, const std::optional<Box>& closely) {
  std::optional<Surface> coarser;
  if (mesh.triangle_count() > most_triangles) {
    // The close region may itself be too large to draw completely.
    const bool is_much = close_triangles(mesh, closely) > most_triangles;
    coarser = coarsened(mesh, most_triangles, is_much ? std::nullopt : closely);
  }
  const std::span<const Vec3> vertices = coarser ? coarser->vertices : mesh.vertices();
  const std::span<const Corners> triangles = coarser ? coarser->triangles : mesh.triangles();
  const PackedMesh bytes = packed(vertices, triangles);
  return {{"name", name},
          {"triangles", mesh.triangle_count()},
          {"vertices", mesh.vertex_count()},
          {"drawn",
           {{"triangles", triangles.size()},
            {"vertices", vertices.size()},
            {"coordinates", bytes.coordinates},
            {"packed", to_base64(gzipped(bytes.bytes))}}}};
}

}  // namespace keepout::app
