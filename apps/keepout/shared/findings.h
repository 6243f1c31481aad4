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

/// Something about a mesh that its user should know before trusting it.
struct Finding {
  std::string_view key;  // stable, for programs
  std::size_t count;     // 1 where there is nothing to count
  std::string_view one;  // what there are `count` of; empty where there is nothing to count
  std::string_view meaning;
  std::string_view advice;
  FaultPlaces places = {};  // none where there is nothing to count
};

/// Returns the findings, the worst first. `self_intersections`: if they were searched for.
std::vector<Finding> findings_of(const MeshFindings& mesh,
                                 const std::optional<SelfIntersections>& self_intersections);

/// Of what there are how many, and what that means, without a full stop: for people.
std::string text_of(const Finding& finding);

}  // namespace keepout::app
