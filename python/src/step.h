// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "keepout/activation/free_polytope.h"
#include "keepout/geometry/shapes.h"
#include "keepout/step/motion.h"

namespace keepout::python {

/// Half-spaces that outlive the step they are of.
struct Planes {
  std::vector<HalfSpace> planes;
};

/// A free polytope, and whether it is one.
struct FreeSpace : Planes {
  PolytopeStatus status = PolytopeStatus::invalid_input;
};

/// A step that outlives the next one.
struct StepResult {
  explicit StepResult(const Step& step);

  Status status;
  Vec3 motion;
  std::vector<double> increment;
  Planes planes;
  std::vector<std::uint32_t> active;
  std::size_t triangles;
  std::optional<double> distance;
};

}  // namespace keepout::python
