// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "verify/scene.h"

namespace keepout::app {

/// Meshes of at most 400 triangles, some 40 mm large, that are drawn anew for each start: `soup`
/// (crossing triangles), `fan` (ridges and valleys around one vertex), `sheets` (1e-9 mm apart),
/// `cone`, `bowl` and `saddle`.
std::vector<Arena> hostile_arenas(const std::string& index);

}  // namespace keepout::app
