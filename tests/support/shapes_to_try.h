// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "keepout/fixtures/shapes.h"
#include "trials.h"

namespace keepout {

/// The generated shapes; every third of them where few trials are enough.
inline std::vector<Shape> shapes_to_try() {
  std::vector<Shape> tried;
  const std::size_t stride = test::few_trials() ? 3 : 1;
  for (std::size_t i = 0; i < shapes().size(); i += stride) tried.push_back(shapes()[i]);
  return tried;
}

/// Their names, for tests that run once for each.
inline std::vector<std::string> names_of_shapes() {
  std::vector<std::string> names;
  for (const Shape& shape : shapes_to_try()) names.emplace_back(shape.name);
  return names;
}

}  // namespace keepout
