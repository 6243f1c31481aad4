// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/indexed_mesh.h"

#include <string>
#include <utility>

#include "bench/subject.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/resample_mesh.h"

namespace keepout::app {
namespace {

Surface surface_of(const Mesh& mesh) {
  return {{mesh.vertices().begin(), mesh.vertices().end()},
          {mesh.triangles().begin(), mesh.triangles().end()}};
}

Surface resampled_bunny(std::size_t triangles) {
  return surface_of(*make_mesh({std::string(resampled_mesh), triangles}));
}

}  // namespace

IndexedMesh with_index(std::shared_ptr<const Mesh> mesh) {
  auto index = std::make_unique<const WideBvh>(mesh);
  return {std::move(mesh), std::move(index)};
}

Surface in_single_precision(Surface surface) {
  for (Vec3& vertex : surface.vertices) vertex = vertex.cast<float>().cast<double>().eval();
  return surface;
}

std::shared_ptr<const Mesh> bunny_of(std::size_t triangles) {
  return std::make_shared<const Mesh>(in_single_precision(resampled_bunny(triangles)));
}

std::filesystem::path large_bunny(std::size_t triangles) {
  const std::filesystem::path folder = fixture_cache() / "made";
  std::filesystem::path file = folder / ("bunny_" + std::to_string(triangles) + ".stl");
  if (std::filesystem::exists(file)) return file;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": cannot be made: " + error.message());
  constexpr std::uint64_t seed = 2;
  write_subdivided(file, resampled_bunny(triangles / 4), seed);
  return file;
}

}  // namespace keepout::app
