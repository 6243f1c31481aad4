// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/campaign.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/error.h"
#include "keepout/registry.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"
#include "verify/robot/excess.h"
#include "verify/robot/hand.h"
#include "verify/robot/judge.h"

namespace keepout::app {
namespace {

constexpr std::size_t block = 500;      // cycles for which a margin stays raised, and then does not
constexpr double raise = 0.5;           // [mm]
constexpr double blocked_below = 0.05;  // of the motion asked for
constexpr double useful_above = 0.05;   // of the largest reduction of the cost
constexpr std::uint64_t sampled = 2000;  // blocked cycles to each that is searched
constexpr int hopeless_after =
    50;  // cycles without any motion being proven, until a start is given up

bool is_raised(Scenario scenario, std::size_t cycle) noexcept {
  const bool is_odd = (cycle / block) % 2 == 1;
  return scenario == Scenario::raised ? is_odd : scenario == Scenario::wedged && !is_odd;
}

/// What is being worked on: a row, and what it is made with.
struct RobotRow {
  Scene& scene;
  std::shared_ptr<const oracle::TriangleTree> tree;
  const RobotUnderTest& robot;
  const RobotCampaign& campaign;
  RobotTally tally;
  std::vector<double> times = {};        // [us]
  std::vector<double> point_times = {};  // [us]
};

/// One instrument, from where it begins.
class RobotAttempt {
 public:
  RobotAttempt(RobotRow& row, const RobotStart& start, Random& random)
      : row_(row),
        random_(random),
        instrument_(row.robot.make(start.base)),
        usual_(options_of(row.campaign, instrument_.chain(), row.tally.speed)),
        constraint_(row.scene.mesh(), row.scene.shared_index(), instrument_,
                    make_solver("active_set"), usual_),
        point_(row.scene.mesh(), row.scene.shared_index(), std::make_unique<CertifiedRule>(),
               make_solver("active_set"),
               {.radius = 10.0 * row.tally.speed,
                .tool_radius = instrument_.bodies().back().radius,
                .margin = usual_.margin}),
        oracle_(row.tree, row.robot.judged(), instrument_.chain().base()),
        judge_(oracle_, instrument_.chain(), random, start.positions, usual_,
               constraint_.tolerance()),
        hand_(row.scene, random, row.tally.speed),
        positions_(start.positions) {}

  void run(std::uint64_t cycles) {
    int failures = 0;
    for (std::uint64_t cycle = 0; cycle < cycles && failures < hopeless_after; ++cycle) {
      if (cycle % block == 0) set_margin(cycle);
      failures = make_cycle() ? 0 : failures + 1;
      if (!waited_) continue;
      ++*waited_;
      if (judge_.is_recovered()) {
        ++row_.tally.recovered;
        row_.tally.recovery_cycles += *waited_;
        waited_.reset();
      }
    }
  }

 private:
  void set_margin(std::size_t cycle) {
    InstrumentOptions options = usual_;
    if (is_raised(row_.tally.scenario, cycle)) options.margin += raise;
    if (options.margin != constraint_.options().margin) {
      constraint_.set_options(options);
      judge_.follow(options);
    }
    waited_.reset();  // what has not recovered within a block has not in time
    const bool is_new = cycle == 0 || is_raised(row_.tally.scenario, cycle);
    if (is_new && !judge_.is_recovered()) {
      ++row_.tally.recoveries;
      waited_ = 0;
    }
  }

  /// Whether there was a motion, be it none at all, that may be carried out.
  bool make_cycle() {
    RobotTally& tally = row_.tally;
    ChainState state;
    instrument_.chain().place(positions_, state);
    const Twist desired = hand_.next(state.flange().position);
    const BenchClock::time_point start = BenchClock::now();
    const InstrumentStep step = constraint_.step(positions_, desired);
    row_.times.push_back(microseconds_since(start));
    const BenchClock::time_point after = BenchClock::now();
    point_.step({.tip = state.flange().position, .desired = desired.linear});
    row_.point_times.push_back(microseconds_since(after));
    RobotTask::Increment made = RobotTask::Increment::Zero(instrument_.chain().size());
    std::vector<double> next = positions_;
    for (std::size_t k = 0; step.ok() && k < next.size(); ++k) {
      made[static_cast<Eigen::Index>(k)] = step.increment[k];
      next[k] += step.increment[k];
    }
    const RobotVerdict verdict = judge_.judge(next);
    ++tally.cycles;
    ++tally.statuses[static_cast<std::size_t>(step.status)];
    tally.below += verdict.is_below ? 1 : 0;
    if (verdict.is_below && verdict.least < 0.0) {
      ++tally.in_mesh;
      tally.deepest = std::max(tally.deepest, -verdict.least);
    }
    tally.limits_broken += verdict.limits_broken ? 1 : 0;
    tally.least_beyond = std::min(tally.least_beyond, verdict.beyond);
    const auto rounds = static_cast<std::uint64_t>(step.rounds);
    tally.rounds += rounds;
    tally.most_rounds = std::max(tally.most_rounds, rounds);
    tally.rows += step.rows;
    tally.most_looks = std::max<std::uint64_t>(tally.most_looks, constraint_.looks());
    const RobotTask task(instrument_.chain(), positions_, desired, constraint_.options());
    const RobotTask::Increment none = RobotTask::Increment::Zero(made.size());
    const bool is_led = step.status == Status::recovering;
    tally.worse += !is_led && task.cost(made) > 1.05 * task.cost(none) ? 1 : 0;
    // What is led out has other things to do than what it is asked for.
    if (!is_led && task.share(made) < blocked_below && tally.blocked++ % sampled == 0) {
      const double more = excess(task, instrument_.chain(), positions_, {made.data(), next.size()},
                                 constraint_.options(), oracle_, random_);
      ++tally.samples;
      tally.excess += more;
      tally.useful += more > useful_above ? 1 : 0;
    }
    positions_ = next;
    return step.ok();
  }

  RobotRow& row_;
  Random& random_;
  Instrument instrument_;
  InstrumentOptions usual_;
  InstrumentConstraint constraint_;
  MotionConstraint point_;  // of a ball at the tip alone: timed beside it
  oracle::InstrumentOracle oracle_;
  RobotJudge judge_;
  RobotHand hand_;
  std::vector<double> positions_;
  std::optional<std::uint64_t> waited_;  // for a margin that is not kept yet [cycles]
};

/// The scenarios at each speed: what is not an approach is done at the first one only.
std::vector<std::pair<Scenario, double>> rows_of(const RobotCampaign& campaign) {
  std::vector<std::pair<Scenario, double>> rows;
  for (const double speed : campaign.speeds) rows.emplace_back(Scenario::approach, speed);
  for (const Scenario s : {Scenario::raised, Scenario::overlapping, Scenario::wedged}) {
    rows.emplace_back(s, campaign.speeds.front());
  }
  return rows;
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

std::uint64_t cycle_count(const RobotCampaign& campaign, std::size_t meshes) noexcept {
  return campaign.cycles * meshes * (campaign.speeds.size() + 3);
}

std::vector<RobotTally> run_robot_campaign(
    const RobotCampaign& campaign, std::span<const Arena> arenas,
    const std::function<Next(const RobotTally&, std::uint64_t)>& advanced) {
  const RobotUnderTest& robot = robot_named(campaign.robot);
  std::vector<RobotTally> tallies;
  for (std::size_t a = 0; a < arenas.size(); ++a) {
    std::vector<Scene> scenes = arenas[a].load();
    Scene& scene = scenes.front();
    const auto tree = std::make_shared<const oracle::TriangleTree>(scene.mesh());
    for (const auto& [scenario, speed] : rows_of(campaign)) {
      RobotRow row{scene,
                   tree,
                   robot,
                   campaign,
                   {.mesh = arenas[a].mesh,
                    .triangles = scene.mesh()->triangle_count(),
                    .scenario = scenario,
                    .speed = speed}};
      RobotTally& tally = row.tally;
      const BenchClock::time_point start = BenchClock::now();
      Next next = Next::go_on;
      while (tally.cycles < campaign.cycles && next == Next::go_on) {
        Random of_seed(campaign.seed + 1000 * static_cast<std::uint64_t>(scenario));
        Random random(of_seed.bits() ^ tally.starts);
        const auto begin = find_start(scene, tree, robot, scenario, campaign.margin, random);
        tally.is_out_of_starts = !begin;
        if (!begin) break;
        ++tally.starts;
        const std::uint64_t before = tally.cycles;
        RobotAttempt(row, *begin, random)
            .run(std::min(cycles_of_a_start, campaign.cycles - before));
        next = advanced(tally, tally.cycles - before);
      }
      tally.step = timing_of(row.times);
      tally.point = timing_of(row.point_times);
      tally.seconds = microseconds_since(start) * 1e-6;
      tallies.push_back(tally);
      if (next == Next::stop) return tallies;
    }
  }
  return tallies;
}

}  // namespace keepout::app
