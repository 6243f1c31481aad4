// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/load_mesh.h"

namespace keepout::app {

// Names of meshes on a command line: a file or a sample mesh, which is one of the real meshes that
// fixtures/prepare makes, or a generated shape. A file has priority over a sample mesh.

/// The help of the argument MESH, and the list of sample meshes.
extern const std::string_view mesh_help;
std::string mesh_names_help();

/// Returns the names of all sample meshes.
std::vector<std::string> fixture_names();

/// Returns the file of a mesh name; the name itself for a generated shape. Throws Error, with
/// similar names, if there is neither a file nor a sample mesh of this name. Throws Error if a real
/// mesh is not prepared.
std::filesystem::path file_of_mesh(const std::filesystem::path& name);

/// Returns the words that name the mesh on a command line: its name, and the options that it was
/// read with.
std::string mesh_words(const std::filesystem::path& mesh, const LoadOptions& load);

/// Reads or generates it. Throws Error.
LoadedMesh read_named_mesh(const std::filesystem::path& name, const LoadOptions& options = {});

/// Like read_named_mesh(), but also writes notices and warnings to stderr, one a line.
LoadedMesh load_named_mesh(const std::filesystem::path& name, const LoadOptions& options = {});

}  // namespace keepout::app
