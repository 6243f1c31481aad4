// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "keepout/fixtures/shapes.h"

namespace keepout {

/// The generated shapes by name, for tests that run once for each.
inline std::vector<std::string> names_of_shapes() {
  std::vector<std::string> names;
  for (const Shape& shape : shapes()) names.emplace_back(shape.name);
  return names;
}

}  // namespace keepout
