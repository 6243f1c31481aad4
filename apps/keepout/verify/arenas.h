// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "campaign.h"

namespace keepout::app {

/// Each generated shape, where it was made and 1e4 mm away.
std::vector<Arena> generated_arenas(std::string_view index);

/// The real meshes in the cache; `missing` is told the others.
std::vector<Arena> real_arenas(std::string_view index, std::vector<std::string>& missing);

/// A mesh that the user names (named_mesh.h). It is read when it is its turn.
Arena named_arena(const std::string& mesh, std::string_view index);

}  // namespace keepout::app
