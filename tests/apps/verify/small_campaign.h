// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/shapes.h"
#include "verify/campaign.h"

namespace keepout::app {

inline Arena arena_of(std::string_view shape) {
  return {std::string(shape), [shape] {
            std::vector<std::unique_ptr<Scene>> scenes;
            scenes.push_back(
                std::make_unique<Scene>(std::string(shape), make_shape(shape), "wide_bvh"));
            return scenes;
          }};
}

inline Findings campaign_on(std::string_view shape, const CampaignSettings& settings) {
  return run_campaign(settings, std::array{arena_of(shape)},
                      [](std::uint64_t) { return Next::go_on; });
}

inline std::uint64_t count(const Findings& findings, Breach breach) {
  return findings.total().breaches[static_cast<std::size_t>(breach)];
}
inline std::uint64_t count(const Findings& findings, Status status) {
  return findings.total().statuses[static_cast<std::size_t>(status)];
}

}  // namespace keepout::app
