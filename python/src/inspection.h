// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "keepout/mesh/doctor.h"

namespace keepout::python {

/// What the doctor found; the search for self-intersections takes longest and is made when asked
/// for.
struct Inspection {
  MeshFindings findings;
  std::optional<std::size_t> self_intersections;
};

/// Without Python's lock.
Inspection inspect(const std::shared_ptr<const Mesh>& mesh, bool self_intersections);

}  // namespace keepout::python
