// SPDX-License-Identifier: BSD-3-Clause
#include "verify/campaign.h"

#include <algorithm>
#include <utility>

#include "verify/attack.h"

namespace keepout::app {
namespace {

Next run(Attack& attack, const Advanced& advanced) {
  Tally& row = attack.row;
  const std::string name = row.mesh + (row.scenario.empty() ? "" : ", " + row.scenario);
  Next next = Next::go_on;
  std::uint64_t most = attack.begin();
  if (most == 0 && !attack.is_done()) return Next::stop;  // a signal came while its mesh was loaded
  const BenchClock::time_point start = BenchClock::now();
  while (most > 0) {
    const std::uint64_t before = row.cycles;
    for (std::uint64_t cycle = 0; cycle < most && attack.cycle(cycle); ++cycle) {
    }
    next = advanced(row.cycles - before, name);
    most = next == Next::go_on ? attack.begin() : 0;
  }
  row.step = attack.step_times.timing();
  row.contact = attack.contact_times.timing();
  row.free = attack.free_times.timing();
  row.point = attack.point_times.timing();
  row.seconds = microseconds_since(start) * 1e-6;
  return next;
}

}  // namespace

std::vector<Campaign::RowKind> Campaign::row_kinds() const {
  std::vector<RowKind> rows;
  const auto add = [&](const Scenario& scenario, std::size_t count) {
    for (std::size_t s = 0; s < count; ++s) rows.push_back({&scenario, speeds[s]});
  };
  for (const std::string& name : scenarios) add(scenario_named(name), speeds.size());
  for (std::size_t s = 0; scenarios.empty() && s < usual_scenarios; ++s) {
    add(app::scenarios()[s], s == 0 ? speeds.size() : 1);
  }
  return rows;
}

std::uint64_t Campaign::length(std::size_t meshes) const {
  return (is_of_instruments() ? cycles * meshes * row_kinds().size() : steps) / shard.count;
}

std::uint64_t trajectory_count(std::uint64_t steps, std::uint64_t length) noexcept {
  return (steps + length - 1) / length;
}

Findings run_campaign(const Campaign& campaign, std::span<const Arena> arenas,
                      const Advanced& advanced) {
  const BenchClock::time_point start = BenchClock::now();
  Findings findings;
  Next next = Next::go_on;
  for (auto& attack : campaign.is_of_instruments() ? attacks_on_instruments(campaign, arenas)
                                                   : attacks_on_tips(campaign, arenas, findings)) {
    bool is_run = next == Next::go_on;
    if (is_run) {
      next = run(*attack, advanced);
      is_run = attack->row.starts > 0 || attack->is_done();
    }
    findings.is_complete = findings.is_complete && attack->is_done();
    // Shards of tips must have the same rows, so that the rows can be added.
    if (is_run || !campaign.is_of_instruments()) findings.rows.push_back(std::move(attack->row));
    attack.reset();  // frees the mesh as well
  }
  findings.seconds = microseconds_since(start) * 1e-6;
  return findings;
}

}  // namespace keepout::app
