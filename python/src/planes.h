// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "keepout/activation/free_polytope.h"
#include "keepout/geometry/half_space.h"

namespace keepout::python {

/// Half-spaces that outlive the step they are of.
struct Planes {
  std::vector<HalfSpace> planes;
};

/// A free polytope, and whether it is one.
struct FreeSpace : Planes {
  PolytopeStatus status = PolytopeStatus::invalid_input;
};

}  // namespace keepout::python
