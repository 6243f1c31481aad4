// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "keepout/step/motion.h"
#include "planes.h"

namespace keepout::python {

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
