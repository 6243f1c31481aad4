// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arenas.h"

#include <utility>

#include "keepout/adapters/load_mesh.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"

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

}  // namespace

std::vector<Arena> generated_arenas(std::string_view index) {
  std::vector<Arena> arenas;
  for (const Shape& shape : shapes()) {
    arenas.push_back({std::string(shape.name),
                      [&shape, index = std::string(index)] { return make_scenes(shape, index); }});
  }
  return arenas;
}

Arena file_arena(const std::filesystem::path& path, std::string name, std::string_view index) {
  return {name, [path, name, index = std::string(index)] {
            Scenes scenes;
            scenes.push_back(std::make_unique<Scene>(name, load_mesh(path).mesh, index));
            return scenes;
          }};
}

std::vector<Arena> real_arenas(std::string_view index, std::vector<std::string>& missing) {
  std::vector<Arena> arenas;
  for (const std::string_view name : real_meshes()) {
    try {
      arenas.push_back(file_arena(fixture_path(name), std::string(name), index));
    } catch (const Error& error) {
      missing.emplace_back(error.what());
    }
  }
  return arenas;
}

}  // namespace keepout::app
