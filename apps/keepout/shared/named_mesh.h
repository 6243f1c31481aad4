// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/load_mesh.h"

namespace keepout::app {

// What a user may name where a command takes a mesh: a file, or a fixture, which is one of the real
// meshes that fixtures/prepare makes, or one of the generated shapes. A file of that name wins.

/// What MESH is, for the help of a command; and which names there are.
extern const std::string_view mesh_help;
std::string mesh_names_help();

/// Returns the names of all fixtures.
std::vector<std::string> fixture_names();

/// The file behind the name; the name itself for a generated shape. Throws Error, with the names
/// that were likely meant, when there is neither a file nor a fixture of that name, and when a real
/// fixture is not prepared.
std::filesystem::path file_of_mesh(const std::filesystem::path& name);

/// Returns the words that name the mesh on a command line: its name, and the options that it was
/// read with.
std::string mesh_words(const std::filesystem::path& mesh, const LoadOptions& load);

/// Reads or generates it. Throws Error.
LoadedMesh read_named_mesh(const std::filesystem::path& name, const LoadOptions& options = {});

/// Like read_named_mesh(), but also writes notices and warnings to stderr, a line each.
LoadedMesh load_named_mesh(const std::filesystem::path& name, const LoadOptions& options = {});

}  // namespace keepout::app
