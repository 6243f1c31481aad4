// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>

#include "keepout/mesh/load_mesh.h"

namespace keepout::app {

struct InspectOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  bool json = false;
  bool self_intersections = false;  // costs seconds where the rest costs a fraction of one
};

/// Reads a mesh file and prints what it is made of and what is wrong with it, in words or as JSON.
/// Throws Error when the file cannot be read; whatever is found in it is no error.
void inspect(const InspectOptions& options, std::ostream& out);

}  // namespace keepout::app
