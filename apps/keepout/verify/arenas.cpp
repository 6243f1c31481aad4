// SPDX-License-Identifier: BSD-3-Clause
#include "arenas.h"

#include <utility>

#include "../named_mesh.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout::app {
namespace {

const Vec3 far_away(10'000.3, -7'000.7, 9'000.1);

using Scenes = std::vector<std::unique_ptr<Scene>>;

Scenes make_scenes(const Shape& shape, const std::string& index) {
  Scenes scenes;
  Surface surface = shape.make();
  Surface moved = surface;
  for (Vec3& vertex : moved.vertices) vertex += far_away;
  const std::string name(shape.name);
  scenes.push_back(std::make_unique<Scene>(name, std::move(surface), index));
  scenes.push_back(
      std::make_unique<Scene>(name + " + (10000.3, -7000.7, 9000.1)", std::move(moved), index));
  return scenes;
}

Scenes scene_of(const std::string& name, const LoadedMesh& loaded, const std::string& index) {
  Scenes scenes;
  scenes.push_back(std::make_unique<Scene>(name, loaded.mesh, index));
  return scenes;
}

}  // namespace

std::vector<Arena> generated_arenas(std::string_view index) {
  std::vector<Arena> arenas;
  for (const Shape& shape : shapes()) {
    arenas.push_back({std::string(shape.name),
                      [&shape, index = std::string(index)] { return make_scenes(shape, index); }});
  }
  return arenas;
}

Arena named_arena(const std::string& mesh, std::string_view index) {
  return {mesh, [mesh, index = std::string(index)] {
            return scene_of(mesh, load_named_mesh(mesh), index);
          }};
}

std::vector<Arena> real_arenas(std::string_view index, std::vector<std::string>& missing) {
  std::vector<Arena> arenas;
  for (const std::string_view name : real_meshes()) {
    try {
      arenas.push_back({std::string(name), [name = std::string(name), path = fixture_path(name),
                                            index = std::string(index)] {
                          // What is wrong with these is known, and why they are here.
                          return scene_of(name, load_mesh(path, {.check = MeshCheck::none}), index);
                        }});
    } catch (const Error& error) {
      missing.emplace_back(error.what());
    }
  }
  return arenas;
}

}  // namespace keepout::app
