// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// What assimp makes of a mesh file, as a program that uses it alone would read it: triangulated,
/// and not welded, which costs it least. Throws Error, also in a build without assimp.
Surface assimp_surface(const std::filesystem::path& file);

}  // namespace keepout::app
