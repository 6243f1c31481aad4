// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "screen.h"

namespace keepout {

/// Reads the contents of a file through assimp, screened beforehand; polygons are triangulated, and
/// nothing is welded. `file` names the file in errors. Appends to `warnings`. Throws Error.
///
/// Assimp holds coordinates in single precision: those of a PLY file are the nearest to the number
/// in the file; those of the other formats are within 1 unit in the last place of it, or 2 when
/// written with an exponent (measured). Equal numerals give equal coordinates, so
/// what was connected in the file is after an exact weld.
///
/// One file is read at a time, whatever the number of threads: assimp's logger is global. For the
/// same reason, a program that uses assimp itself, in another thread and at the same time, should
/// have created a logger of its own before (Assimp::DefaultLogger::create), which is then shared.
Surface read_with_assimp(MeshFormat format, std::string_view contents, const std::string& file,
                         std::vector<std::string>& warnings);

}  // namespace keepout
