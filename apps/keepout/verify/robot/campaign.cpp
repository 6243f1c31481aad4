// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/campaign.h"

#include <algorithm>
#include <utility>

namespace keepout::app {
namespace {

// An instrument begins anew after so many cycles; the fewer where mesh or robot are drawn.
constexpr std::uint64_t cycles_of_a_start = 2000;
constexpr std::uint64_t cycles_of_a_drawn_start = 400;

using DrawMesh = std::function<std::shared_ptr<Scene>(Random&)>;

Next run_row(const RobotCampaign& campaign, const Scenario& scenario, const DrawMesh& draw_mesh,
             bool is_drawn, RobotTally& tally, const Advanced& advanced) {
  const RobotUnderTest* robot = campaign.robot.empty() ? nullptr : &robot_named(campaign.robot);
  const auto number = static_cast<std::uint64_t>(&scenario - scenarios().data());
  const std::uint64_t longest = is_drawn ? cycles_of_a_drawn_start : cycles_of_a_start;
  const int most_misses = is_drawn ? 20 : 1;  // the next draw may have a start
  const auto options = [&](const Chain& chain) { return options_of(campaign, chain, tally.speed); };
  const BenchClock::time_point start = BenchClock::now();
  RobotTimes times;
  Next next = Next::go_on;
  int misses = 0;  // setups without a place to begin, one after the other
  for (std::uint64_t draw = 0; tally.cycles < campaign.cycles && next == Next::go_on; ++draw) {
    Random of_seed(campaign.seed + 1000 * number);
    Random random(of_seed.bits() ^ draw);
    auto setup = draw_setup(scenario, robot, tally.speed, random, draw_mesh, options);
    misses = setup ? 0 : misses + 1;
    tally.is_out_of_starts = misses >= most_misses;
    if (tally.is_out_of_starts) break;
    if (!setup) continue;
    setup->is_drawn = is_drawn;
    ++tally.starts;
    tally.period = setup->options.period;
    const std::uint64_t before = tally.cycles;
    run_attempt(campaign, std::move(*setup), random, std::min(longest, campaign.cycles - before),
                tally, times);
    next = advanced(tally.cycles - before, tally.mesh + ", " + tally.scenario);
  }
  tally.step = timing_of(times.step);
  tally.point = timing_of(times.point);
  tally.seconds = microseconds_since(start) * 1e-6;
  return next;
}

}  // namespace

InstrumentOptions options_of(const RobotCampaign& campaign, const Chain& chain, double speed) {
  InstrumentOptions options{.margin = campaign.margin,
                            .band = std::min(0.002, 0.05 * campaign.margin),
                            .certified = campaign.motion};
  for (int k = 1; k <= chain.size(); ++k) {
    const double needed = chain.joint(k).kind == JointKind::revolute ? 0.1 : 2.5;
    options.period = std::max(options.period, speed * needed / chain.joint(k).limits.velocity);
  }
  return options;
}

std::vector<std::pair<const Scenario*, double>> rows_of(const RobotCampaign& campaign) {
  std::vector<std::pair<const Scenario*, double>> rows;
  const auto add = [&](const Scenario& scenario, std::size_t speeds) {
    for (std::size_t s = 0; s < speeds; ++s) rows.emplace_back(&scenario, campaign.speeds[s]);
  };
  for (const std::string& name : campaign.scenarios) {
    add(scenario_named(name), campaign.speeds.size());
  }
  for (std::size_t s = 0; campaign.scenarios.empty() && s < usual_scenarios; ++s) {
    add(scenarios()[s], s == 0 ? campaign.speeds.size() : 1);
  }
  return rows;
}

std::uint64_t cycle_count(const RobotCampaign& campaign, std::size_t meshes) {
  return campaign.cycles * meshes * rows_of(campaign).size();
}

std::uint64_t breaches(const RobotTally& tally) noexcept {
  return tally.below + tally.limits_broken + tally.guides_left + tally.strayed;
}

std::vector<RobotTally> run_campaign(const RobotCampaign& campaign, std::span<const Arena> arenas,
                                     const Advanced& advanced) {
  std::vector<RobotTally> tallies;
  for (const Arena& arena : arenas) {
    std::shared_ptr<Scene> loaded;
    if (arena.load) loaded = std::make_shared<Scene>(std::move(arena.load().front()));
    const DrawMesh draw_mesh = [&](Random& random) { return loaded ? loaded : arena.draw(random); };
    for (const auto& [scenario, speed] : rows_of(campaign)) {
      tallies.push_back({.mesh = arena.mesh,
                         .triangles = loaded ? loaded->mesh()->triangle_count() : 0,
                         .scenario = std::string(scenario->name),
                         .speed = speed});
      const bool is_drawn =
          !loaded || campaign.robot.empty() || scenario->carrier == Carrier::slides;
      if (run_row(campaign, *scenario, draw_mesh, is_drawn, tallies.back(), advanced) ==
          Next::stop) {
        return tallies;
      }
    }
  }
  return tallies;
}

}  // namespace keepout::app
