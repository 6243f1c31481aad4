// SPDX-License-Identifier: BSD-3-Clause
#include "compare/subject.h"

#include <filesystem>

#include "keepout/fixtures/resample_mesh.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/used_cores.h"

namespace keepout::app {

std::string label_of(const Subject& subject) {
  return std::filesystem::path(subject.mesh).filename().string();
}

std::string title_of(const Subject& subject) {
  if (subject.triangles == 0) return label_of(subject);
  return subject.mesh + ", " + counted(subject.triangles, "triangle");
}

LoadedSubject load(const Subject& subject) {
  const UsedCores used;
  LoadedSubject loaded{.mesh = load_named_mesh(subject.mesh).mesh, .seconds = 0.0, .cores = 0.0};
  loaded.seconds = used.seconds();
  loaded.cores = used.own();
  if (subject.triangles == 0) return loaded;
  std::shared_ptr<const Mesh>& mesh = loaded.mesh;
  constexpr double largest_extent = 150.0;  // [mm]
  Surface bunny = surface_of(*mesh);
  mesh.reset();
  constexpr std::uint64_t seed = 1;
  mesh = std::make_shared<const Mesh>(
      resampled(scaled(std::move(bunny), largest_extent), subject.triangles, seed));
  return loaded;
}

std::shared_ptr<const Mesh> make_mesh(const Subject& subject) { return load(subject).mesh; }

Surface surface_of(const Mesh& mesh) {
  return {{mesh.vertices().begin(), mesh.vertices().end()},
          {mesh.triangles().begin(), mesh.triangles().end()}};
}

}  // namespace keepout::app
