// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/campaign.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "verify/robot/attempt.h"

namespace keepout::app {
namespace {

void run_row(RobotRow& row, const std::function<Next(const RobotTally&, std::uint64_t)>& advanced,
             Next& next) {
  RobotTally& tally = row.tally;
  const RobotCampaign& campaign = row.campaign;
  const auto number = static_cast<std::uint64_t>(&row.scenario - scenarios().data());
  const std::uint64_t longest = row.is_drawn ? cycles_of_a_drawn_start : cycles_of_a_start;
  int misses = 0;  // setups without a place to begin, one after the other
  for (std::uint64_t draw = 0; tally.cycles < campaign.cycles && next == Next::go_on; ++draw) {
    Random of_seed(campaign.seed + 1000 * number);
    Random random(of_seed.bits() ^ draw);
    const auto options = [&](const Chain& chain) {
      return options_of(campaign, chain, tally.speed);
    };
    auto setup = draw_setup(row.scenario, row.robot, tally.speed, random, row.draw_mesh, options);
    // If mesh and robot are drawn, the next draw may have a start.
    const int most_misses = row.is_drawn ? 20 : 1;
    misses = setup ? 0 : misses + 1;
    tally.is_out_of_starts = misses >= most_misses;
    if (tally.is_out_of_starts) break;
    if (!setup) continue;
    ++tally.starts;
    tally.period = setup->options.period;
    const std::uint64_t before = tally.cycles;
    run_attempt(row, std::move(*setup), random, std::min(longest, campaign.cycles - before));
    next = advanced(tally, tally.cycles - before);
  }
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

std::vector<RobotRowPlan> rows_of(const RobotCampaign& campaign) {
  std::vector<RobotRowPlan> rows;
  const auto add = [&](const Scenario& scenario, std::size_t speeds) {
    for (std::size_t s = 0; s < speeds; ++s) rows.push_back({&scenario, campaign.speeds[s]});
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

std::vector<RobotTally> run_robot_campaign(
    const RobotCampaign& campaign, std::span<const Arena> arenas,
    const std::function<Next(const RobotTally&, std::uint64_t)>& advanced) {
  const RobotUnderTest* robot = campaign.robot.empty() ? nullptr : &robot_named(campaign.robot);
  std::vector<RobotTally> tallies;
  Next next = Next::go_on;
  for (const Arena& arena : arenas) {
    const auto judged = [](std::shared_ptr<Scene> scene) {
      auto tree = std::make_shared<const oracle::TriangleTree>(scene->mesh());
      return JudgedMesh{std::move(scene), std::move(tree)};
    };
    std::optional<JudgedMesh> loaded;
    if (arena.load) loaded = judged(std::make_shared<Scene>(std::move(arena.load().front())));
    const auto draw_mesh = [&](Random& random) {
      return loaded ? *loaded : judged(arena.draw(random));
    };
    for (const auto& [scenario, speed] : rows_of(campaign)) {
      const bool is_drawn = !loaded || robot == nullptr || scenario->carrier == Carrier::slides;
      RobotRow row{.campaign = campaign,
                   .scenario = *scenario,
                   .draw_mesh = draw_mesh,
                   .is_drawn = is_drawn,
                   .robot = robot,
                   .tally = {.mesh = arena.mesh,
                             .triangles = loaded ? loaded->scene->mesh()->triangle_count() : 0,
                             .scenario = std::string(scenario->name),
                             .speed = speed}};
      const BenchClock::time_point start = BenchClock::now();
      run_row(row, advanced, next);
      row.tally.step = timing_of(row.times);
      row.tally.point = timing_of(row.point_times);
      row.tally.seconds = microseconds_since(start) * 1e-6;
      tallies.push_back(std::move(row.tally));
      if (next == Next::stop) return tallies;
    }
  }
  return tallies;
}

}  // namespace keepout::app
