// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/shapes.h"
#include "verify/campaign.h"
#include "verify/result.h"

namespace keepout::app {

inline const Advanced go_on = [](std::uint64_t, const std::string&) { return Next::go_on; };

inline Arena arena_of(std::string_view shape) {
  return {std::string(shape), [shape] {
            return std::vector{Scene(std::string(shape), make_shape(shape), "wide_bvh")};
          }};
}

inline Findings campaign_on(std::string_view shape, const CampaignSettings& settings) {
  return run_campaign(settings, std::array{arena_of(shape)}, go_on);
}

/// Over all meshes.
inline Json total(const Findings& findings) { return result_of({}, findings).record.at("total"); }

inline std::uint64_t count(const Findings& findings, Breach breach) {
  return total(findings).at("breaches").at(std::string(name(breach))).get<std::uint64_t>();
}

}  // namespace keepout::app
