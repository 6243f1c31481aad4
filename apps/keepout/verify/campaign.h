// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "guard.h"
#include "scene.h"
#include "tally.h"

namespace keepout::app {

/// A mesh that a campaign may load: the same, maybe in several places, one scene each.
struct Arena {
  std::string mesh;
  std::function<std::vector<std::unique_ptr<Scene>>()> load;
};

/// A part of a campaign: the trajectories whose number, divided by `count`, leaves `index` - 1.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
};

/// What a campaign does. With the same seed, steps and arenas each trajectory is the same, whatever
/// the shards.
struct CampaignSettings {
  std::uint64_t seed = 1;
  std::uint64_t steps = 1'000'000;
  Shard shard = {};
  std::unique_ptr<Guard> (*make_guard)(const Scene&) = make_certified_guard;
};

inline constexpr std::uint64_t steps_of_a_trajectory = 500;
std::uint64_t trajectory_count(std::uint64_t steps) noexcept;

/// Whether to go on after a trajectory of that many steps.
enum class Next : std::uint8_t { go_on, stop };

/// Runs trajectories, mesh by mesh, so that only one is in memory at a time; `advanced` is told the
/// number of steps after each. Where it says stop, the findings are of those that were run.
Findings run_campaign(const CampaignSettings& settings, std::span<const Arena> arenas,
                      const std::function<Next(std::uint64_t)>& advanced);

}  // namespace keepout::app
