// SPDX-License-Identifier: BSD-3-Clause
#include "shared/named_mesh.h"

#include <algorithm>
#include <array>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/option_table.h"
#include "shared/names.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

std::vector<std::string> real_names() { return {real_meshes().begin(), real_meshes().end()}; }

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Anything there but a folder, which is no mesh and so hides none.
bool is_file(const std::filesystem::path& path) {
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(path, none);
  return std::filesystem::exists(status) && !std::filesystem::is_directory(status);
}

bool is_shape(const std::filesystem::path& name) {
  return !is_file(name) && contains(names(shapes()), name.string());
}

/// One of the real meshes that fixtures/prepare makes.
bool is_prepared(const std::filesystem::path& name) {
  return !is_file(name) && contains(real_names(), name.string());
}

/// The meshes in the folder where the user thought there was this one.
std::vector<std::string> files_beside(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 6> extensions{".stl", ".ply", ".obj",
                                                       ".off", ".vtk", ".vtp"};
  const std::filesystem::path folder = path.parent_path();
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string extension = entry->path().extension().string();
    const bool is_mesh = std::ranges::find(extensions, extension) != extensions.end();
    if (is_mesh && is_file(entry->path())) {
      files.push_back((folder / entry->path().filename()).string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

[[noreturn]] void refuse(const std::filesystem::path& path) {
  const std::vector<std::string> fixtures = fixture_names();
  std::vector<std::string> known = files_beside(path);
  known.insert(known.end(), fixtures.begin(), fixtures.end());
  const std::string name = path.string();
  const std::string stem = path.stem().string();
  std::string hint = did_you_mean(name, known);
  if (hint.empty() && contains(fixtures, stem)) hint = did_you_mean(stem, fixtures);
  throw Error(name + ": there is no such file, and no fixture of that name" +
              (hint.empty() ? "; fixtures are " + enumerated(fixtures) : hint));
}

LoadedMesh generate(const std::filesystem::path& name, const LoadOptions& options) {
  if (options.space != AnatomicalSpace::unstated && options.space != options.untagged) {
    throw Error(name.string() + ": is generated, and in no anatomical space: leave --space out");
  }
  LoadedMesh loaded{.mesh = std::make_shared<const Mesh>(make_shape(name.string())),
                    .space = options.untagged};
  loaded.vertices_in_file = loaded.mesh->vertex_count();
  if (options.check == MeshCheck::quick) {
    for (const std::string& warning : quick_check(*loaded.mesh)) {
      loaded.warnings.push_back(name.string() + ": " + warning);
    }
  }
  return loaded;
}

}  // namespace

const std::string_view mesh_help =
    "Mesh file in mm, STL, PLY, OBJ, OFF, VTK or VTP; or the name of a fixture, such as skull or "
    "cube: see "
    "'keepout --help'";

std::string mesh_names_help() {
  return "MESH is a file, or, where there is no file of that name, a fixture:\n"
         "  prepared   " +
         enumerated(real_names()) + "\n" + "  generated  " + enumerated(names(shapes())) + "\n";
}

std::vector<std::string> fixture_names() {
  std::vector<std::string> fixtures = real_names();
  for (std::string& shape : names(shapes())) fixtures.push_back(std::move(shape));
  return fixtures;
}

std::filesystem::path file_of_mesh(const std::filesystem::path& name) {
  if (is_file(name) || is_shape(name)) return name;
  if (is_prepared(name)) return fixture_path(name.string());
  std::error_code error;
  const bool exists = std::filesystem::exists(std::filesystem::status(name, error));
  // load_mesh() refuses a folder, and a path that cannot be followed, and says why.
  if (exists || (error && error != std::errc::no_such_file_or_directory)) return name;
  refuse(name);
}

std::string mesh_words(const std::filesystem::path& mesh, const LoadOptions& load) {
  std::string words = shell_word(mesh.string());
  for (const auto& [option, space] :
       {std::pair("--space", load.space), std::pair("--untagged", load.untagged)}) {
    if (space == AnatomicalSpace::unstated) continue;
    words.append(" ").append(option).append(" ").append(name(space));
  }
  if (!load.unit.empty()) words += " --unit " + load.unit;
  if (load.scale) words += " --scale " + keepout::text_of(OptionValue(*load.scale));
  if (load.flip) words += " --flip";
  return words;
}

LoadedMesh read_named_mesh(const std::filesystem::path& name, const LoadOptions& options) {
  const bool is_sample = is_shape(name) || is_prepared(name);
  if (is_sample && (!options.unit.empty() || options.scale || options.flip)) {
    throw Error(name.string() +
                ": is a sample mesh, in mm and wound as it should be: leave --unit, --scale and "
                "--flip out");
  }
  return is_shape(name) ? generate(name, options) : load_mesh(file_of_mesh(name), options);
}

LoadedMesh load_named_mesh(const std::filesystem::path& name, const LoadOptions& options) {
  LoadedMesh loaded = read_named_mesh(name, options);
  for (const auto* sentences : {&loaded.notices, &loaded.warnings}) {
    for (const std::string& sentence : *sentences) warn_on_stderr(sentence);
  }
  return loaded;
}

}  // namespace keepout::app
