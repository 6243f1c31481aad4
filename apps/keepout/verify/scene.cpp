// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/diagnostics.h"
#include "shared/named_mesh.h"

namespace keepout::app {

Scene::Scene(std::string name, Surface surface, std::string_view index)
    : Scene(std::move(name), std::make_shared<const Mesh>(std::move(surface)), index) {}

Scene::Scene(std::string name, std::shared_ptr<const Mesh> mesh, std::string_view index)
    : name_(std::move(name)),
      mesh_(std::move(mesh)),
      index_(make_index(index, mesh_)),
      judged_(mesh_),
      nearest_(*mesh_, *index_),
      has_sides_(is_watertight(*mesh_)) {
  for (TriangleId t = 0; t < mesh_->triangle_count(); ++t) {
    const Triangle c = mesh_->triangle(t);
    for (int e = 0; e < 3; ++e) {
      mean_edge_ += (c[(e + 1) % 3] - c[e]).norm();
      farthest_ = std::max(farthest_, c[e].lpNorm<1>());
    }
  }
  mean_edge_ /= 3.0 * static_cast<double>(mesh_->triangle_count());
  if (!(mean_edge_ > 0.0)) mean_edge_ = 1.0;  // all triangles are points
}

void require_area(const std::string& name, const Mesh& mesh) {
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle c = mesh.triangle(t);
    if ((c[1] - c[0]).cross(c[2] - c[0]).norm() > 0.0) return;
  }
  throw Error(name + ": none of its triangles has an area; check the export");
}

std::vector<Arena> generated_arenas(const std::string& index) {
  const Vec3 far_away(10'000.3, -7'000.7, 9'000.1);
  std::vector<Arena> arenas;
  for (const Shape& shape : shapes()) {
    const std::string name(shape.name);
    arenas.push_back({name, [&shape, name, index, far_away] {
                        Surface moved = shape.make();
                        for (Vec3& vertex : moved.vertices) vertex += far_away;
                        const std::string moved_name = name + " + (10000.3, -7000.7, 9000.1)";
                        return std::vector{Scene(name, shape.make(), index),
                                           Scene(moved_name, std::move(moved), index)};
                      }});
  }
  return arenas;
}

std::vector<Arena> real_arenas(const std::string& index, std::vector<std::string>& missing) {
  std::vector<Arena> arenas;
  for (const std::string_view fixture : real_meshes()) {
    try {
      const std::string name(fixture);
      arenas.push_back({name, [name, path = fixture_path(name), index] {
                          // Their defects are known and intended.
                          const LoadedMesh loaded = load_mesh(path, {.check = MeshCheck::none});
                          return std::vector{Scene(name, loaded.mesh, index)};
                        }});
    } catch (const Error& error) {
      missing.emplace_back(error.what());
    }
  }
  return arenas;
}

Arena named_arena(const std::string& mesh, const std::string& index) {
  return {mesh, [mesh, index] {
            const std::shared_ptr<const Mesh> loaded = load_named_mesh(mesh).mesh;
            require_area(mesh, *loaded);
            return std::vector{Scene(mesh, loaded, index)};
          }};
}

}  // namespace keepout::app
