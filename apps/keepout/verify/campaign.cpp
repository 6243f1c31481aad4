// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "campaign.h"

#include <algorithm>
#include <chrono>

#include "trajectory.h"

namespace keepout::app {
namespace {

/// The numbers that one trajectory is drawn from: they have nothing to do with those of another.
Random random_of(std::uint64_t seed, std::uint64_t trajectory) {
  Random of_seed(seed);
  Random of_trajectory(of_seed.bits() ^ trajectory);
  return Random(of_trajectory.bits());
}

std::uint64_t length_of(std::uint64_t trajectory, std::uint64_t steps) {
  return std::min(steps_of_a_trajectory, steps - trajectory * steps_of_a_trajectory);
}

}  // namespace

std::uint64_t trajectory_count(std::uint64_t steps) noexcept {
  return (steps + steps_of_a_trajectory - 1) / steps_of_a_trajectory;
}

Findings run_campaign(const CampaignSettings& settings, std::span<const Arena> arenas,
                      const std::function<Next(std::uint64_t)>& advanced) {
  std::vector<std::vector<std::uint64_t>> trajectories(arenas.size());
  const std::uint64_t count = trajectory_count(settings.steps);
  for (std::uint64_t n = settings.shard.index - 1; n < count; n += settings.shard.count) {
    trajectories[random_of(settings.seed, n).below(arenas.size())].push_back(n);
  }

  using Clock = std::chrono::steady_clock;
  Findings findings;
  Next next = Next::go_on;
  for (std::size_t a = 0; a < arenas.size(); ++a) {
    SceneResult result{.mesh = arenas[a].mesh};
    if (!trajectories[a].empty() && next == Next::go_on) {
      const std::vector<std::unique_ptr<Scene>> scenes = arenas[a].load();
      std::vector<std::unique_ptr<Guard>> guards;
      for (const auto& scene : scenes) guards.push_back(settings.make_guard(*scene));
      result.triangles = scenes.front()->mesh()->triangle_count();
      const Clock::time_point start = Clock::now();
      for (const std::uint64_t n : trajectories[a]) {
        Random random = random_of(settings.seed, n);
        random.bits();  // which chose the arena
        // The first scene is where the mesh was made; others are a minority.
        const bool is_elsewhere = scenes.size() > 1 && random.uniform() < 0.125;
        const std::size_t s = is_elsewhere ? 1 + random.below(scenes.size() - 1) : 0;
        const std::uint64_t steps = length_of(n, settings.steps);
        run_trajectory(*scenes[s], *guards[s], n, steps, random, result.tally, findings);
        next = advanced(steps);
        if (next == Next::stop) break;
      }
      result.tally.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    }
    findings.scenes.push_back(std::move(result));
  }
  return findings;
}

}  // namespace keepout::app
