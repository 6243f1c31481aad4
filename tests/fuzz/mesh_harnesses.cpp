// SPDX-License-Identifier: BSD-3-Clause
// Readers of meshes and of saved indices.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <numeric>
#include <sstream>

#include "digest.h"
#include "fuzz/harness.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/index_cache.h"
#include "keepout/mesh/binary_ply.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout::fuzz {
namespace {

/// Writes the mesh as binary PLY, which is exact, and reads it back.
void require_written_back(const Mesh& mesh) {
  std::ostringstream out;
  write_binary_ply(out,
                   {{mesh.vertices().begin(), mesh.vertices().end()},
                    {mesh.triangles().begin(), mesh.triangles().end()}},
                   AnatomicalSpace::unstated);
  const std::string text = out.str();
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const auto again = load_mesh(scratch_file("again.ply", bytes), {.check = MeshCheck::none}).mesh;
  require(std::ranges::equal(mesh.vertices(), again->vertices()) &&
              std::ranges::equal(mesh.triangles(), again->triangles()),
          "binary PLY is exact");
}

void read_mesh(const char* name, Bytes bytes) {
  const auto file = scratch_file(name, bytes);
  LoadedMesh loaded;
  try {
    loaded = load_mesh(file);
  } catch (const Error& error) {
    require(std::string_view(error.what()).starts_with(file.string()), "errors name the file");
    return;
  }
  const Mesh& mesh = *loaded.mesh;
  require(mesh.triangle_count() > 0, "a mesh has a triangle");
  for (const Vec3& v : mesh.vertices()) {
    require(v.cwiseAbs().maxCoeff() <= 1e30, "coordinates are finite, and at most 1e30");
  }
  for (const Corners& corners : mesh.triangles()) {
    require(std::ranges::max(corners) < mesh.vertex_count(), "corners exist");
  }
  if (mesh.triangle_count() > 10'000) return;  // many triangles in few bytes take too long
  require_written_back(mesh);
  ignore_errors([&] {
    load_mesh(file, {.space = AnatomicalSpace::lps,
                     .untagged = AnatomicalSpace::ras,
                     .unit = "m",
                     .flip = true});
  });
}

std::shared_ptr<const Mesh> small_mesh() {
  static const auto mesh = std::make_shared<const Mesh>(make_sphere(40.0));
  return mesh;
}

/// Returns a file whose head is valid for the mesh and for this order of triangles.
std::vector<std::uint8_t> index_file(Bytes order) {
  static const std::string head = [] {
    const auto file = scratch_file("valid.wide_bvh", {});
    require(save_index(WideBvh(small_mesh()), file), "the index is saved");
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }();
  constexpr std::size_t digest_at = 40;
  std::vector<std::uint8_t> bytes(head.begin(), head.begin() + digest_at);
  const Digest digest = shared_digest_of(std::as_bytes(order));
  const auto* const first = reinterpret_cast<const std::uint8_t*>(&digest);
  bytes.insert(bytes.end(), first, first + sizeof digest);
  bytes.insert(bytes.end(), order.begin(), order.end());
  return bytes;
}

/// The first byte chooses between any file, a valid head before any order, and a valid head before
/// an order of swapped triangles.
void read_index(Bytes bytes) {
  const std::shared_ptr<const Mesh> mesh = small_mesh();
  Source source(bytes);
  const std::size_t kind = source.below(3);
  std::vector<TriangleId> order(mesh->triangle_count());
  std::iota(order.begin(), order.end(), TriangleId{0});
  while (kind == 2 && !source.is_empty()) {
    const std::size_t one = source.below(order.size());
    std::swap(order[one], order[source.below(order.size())]);
  }
  const Bytes swapped(reinterpret_cast<const std::uint8_t*>(order.data()),
                      order.size() * sizeof(TriangleId));
  std::vector<std::uint8_t> contents(source.rest().begin(), source.rest().end());
  if (kind == 1) {
    contents.resize(swapped.size());
    contents = index_file(contents);
  }
  if (kind == 2) contents = index_file(swapped);
  const auto index = load_index(mesh, scratch_file("any.wide_bvh", contents));
  require(kind != 2 || index, "a valid file is loaded");
  if (!index) return;
  std::vector<TriangleId> loaded = index->order();
  std::ranges::sort(loaded);
  std::ranges::sort(order);
  require(loaded == order, "a loaded index has each triangle once");
  const BruteForce all(mesh);
  for (TriangleId t = 0; t < mesh->triangle_count(); t += 7) {
    const Vec3 point = 1.1 * mesh->triangle(t)[0];
    Budget one, other;
    const auto distance = [&](TriangleId id) {
      return closest_point(mesh->triangle(id), point).distance;
    };
    require(distance(index->nearest(point, one)) == distance(all.nearest(point, other)),
            "a loaded index finds the nearest triangle");
  }
}

}  // namespace

std::span<const Harness> mesh_harnesses() noexcept {
  static constexpr Harness all[] = {
      {"stl", "engine/src/mesh/binary_stl.cpp engine/src/mesh/text_formats.cpp",
       [](Bytes bytes) { read_mesh("mesh.stl", bytes); }},
      {"ply", "engine/src/mesh/ply.cpp engine/src/mesh/ply_header.cpp",
       [](Bytes bytes) { read_mesh("mesh.ply", bytes); }},
      {"obj", "engine/src/mesh/text_formats.cpp engine/src/mesh/text_lines.cpp",
       [](Bytes bytes) { read_mesh("mesh.obj", bytes); }},
      {"off", "engine/src/mesh/text_formats.cpp engine/src/mesh/polygons.cpp",
       [](Bytes bytes) { read_mesh("mesh.off", bytes); }},
      {"vtk", "engine/src/mesh/vtk_legacy.cpp engine/src/mesh/vtk_cells.h",
       [](Bytes bytes) { read_mesh("mesh.vtk", bytes); }},
      {"vtp", "engine/src/mesh/vtp.cpp engine/src/mesh/vtp_document.cpp",
       [](Bytes bytes) { read_mesh("mesh.vtp", bytes); }},
      {"index_cache", "engine/src/index/index_cache.cpp", read_index},
  };
  return all;
}

}  // namespace keepout::fuzz
