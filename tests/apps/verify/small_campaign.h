// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "keepout/fixtures/shapes.h"
#include "verify/result.h"

namespace keepout::app {

inline const Advanced go_on = [](std::uint64_t, const std::string&) { return Next::go_on; };

/// Returns a kind of hostile mesh for instruments, or a generated shape.
inline Arena arena_of(std::string_view name) {
  for (Arena& arena : hostile_arenas("wide_bvh")) {
    if (arena.mesh == name) return std::move(arena);
  }
  return {std::string(name),
          [name] { return std::vector{Scene(std::string(name), make_shape(name), "wide_bvh")}; }};
}

inline Findings campaign_on(std::string_view mesh, const Campaign& campaign) {
  return run_campaign(campaign, std::array{arena_of(mesh)}, go_on);
}

}  // namespace keepout::app
