// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "operators/attacker.h"
#include "plan/judge_joint_path.h"
#include "plan/problems.h"

namespace keepout::app {
namespace {

constexpr int cycles_of_the_hand = 3000;
constexpr int looked_at_each = 20;         // [cycles]
constexpr double speed_of_the_hand = 4.0;  // see Attacker
constexpr double least_advance = 30;       // [mm]
constexpr double finer_than = 2.0;         // the farthest place is not looked for [mm]
constexpr std::size_t most_starts = 100;   // to each problem that is asked for

/// Where the hand leads an instrument from a beginning, if that is far enough and in the way of the
/// straight motion.
std::optional<PlanningProblem> led_by_hand(RobotScene& on, const RobotStart& start,
                                           Random& random) {
  const Instrument instrument = on.robot.make(start.base);
  // A period so long that a hand is not slowed down by the limits of velocity.
  InstrumentConstraint guard = make_instrument_constraint(
      on.scene.mesh(), on.scene.shared_index(), instrument,
      {.options = {.margin = 2.1 * on.margin, .band = 0.1 * on.margin, .period = 0.1}});
  InstrumentConstraint straight = make_instrument_constraint(
      on.scene.mesh(), on.scene.shared_index(), instrument, {.options = {.margin = on.margin}});
  oracle::InstrumentOracle judge(on.scene.tree(), on.robot.judged(), start.base);
  Attacker hand(on.scene, random, speed_of_the_hand);
  ChainState state;
  instrument.chain().forward_kinematics(start.positions, state);
  const Pose first = state.flange();
  const Vec3 along = first.rotation.col(2);

  PlanningProblem problem{.start = start.positions, .base = start.base};
  double farthest = least_advance;
  std::vector<double> q = start.positions;
  for (int cycle = 1; cycle <= cycles_of_the_hand; ++cycle) {
    const InstrumentStep step = guard.step(q, hand.next(state.flange().position));
    for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += step.increment[k];
    instrument.chain().forward_kinematics(q, state);
    const double advance = along.dot(state.flange().position - first.position);
    if (cycle % looked_at_each != 0 || advance <= farthest + finer_than) continue;
    const std::array<std::vector<double>, 2> way{start.positions, q};
    if (judge_joint_path(judge, straight, way).entering == 0) continue;
    problem.goal = q;
    farthest = advance;
  }
  if (problem.goal.empty()) return std::nullopt;
  const Mat3& base = start.base.rotation;
  problem.members = {
      {"base_position", json_of(start.base.position)},
      {"base_rotation", {json_of(base.row(0)), json_of(base.row(1)), json_of(base.row(2))}},
      {"start", problem.start},
      {"goal", problem.goal},
      {"advance_mm", farthest}};
  return problem;
}

}  // namespace

std::vector<PlanningProblem> draw_problems(RobotScene& on, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<PlanningProblem> problems;
  for (std::size_t i = 0; i < most_starts * count && problems.size() < count; ++i) {
    // The hand begins with more than it is to keep.
    const auto start = on.start(random, 2.1);
    if (!start) break;
    std::optional<PlanningProblem> problem = led_by_hand(on, *start, random);
    if (!problem) continue;
    problem->number = problems.size() + 1;
    problems.push_back(std::move(*problem));
  }
  if (problems.size() < count) {
    throw Error(on.scene.name() + ": only " + std::to_string(problems.size()) + " of " +
                std::to_string(count) + " problems were found for " + std::string(on.robot.name) +
                "; ask for fewer --problems, or for a smaller --margin");
  }
  return problems;
}

}  // namespace keepout::app
