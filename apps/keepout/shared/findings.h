// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/index/self_intersection.h"
#include "keepout/mesh/diagnostics.h"

namespace keepout::app {

/// A property of a mesh that its user must know before trusting the mesh.
struct Finding {
  std::string_view key;  // stable, for programs
  std::size_t count;     // 1 if there is nothing to count
  std::string_view one;  // the noun that `count` counts; empty if there is nothing to count
  std::string_view meaning;
  std::string_view advice;
  FaultPlaces places = {};  // empty if there is nothing to count
};

/// Returns the findings, the worst first. `self_intersections`: empty if they were not searched
/// for. `is_scaled`: the user gave a unit or a scale.
std::vector<Finding> findings_of(const MeshFindings& mesh,
                                 const std::optional<SelfIntersections>& self_intersections,
                                 bool is_scaled = false);

/// Returns the count and the meaning as text for people, without a full stop.
std::string text_of(const Finding& finding);

}  // namespace keepout::app
