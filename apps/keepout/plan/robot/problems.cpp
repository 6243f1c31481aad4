// SPDX-License-Identifier: BSD-3-Clause
#include "plan/robot/problems.h"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "clip.h"
#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "plan/robot/judge_path.h"

namespace keepout::app {
namespace {

constexpr int cycles_of_the_way = 3000;
constexpr int heading_lasts = 100;        // [cycles]
constexpr int looked_at_each = 20;        // [cycles]
constexpr double fastest_way = 2.0;       // in a cycle [mm]
constexpr double fastest_turn = 0.08;     // in a cycle [rad]
constexpr double finer_than = 2.0;        // the farthest place is not looked for [mm]
constexpr double least_advance = 30.0;    // [mm]
constexpr std::size_t most_starts = 100;  // to each problem that is asked for

/// Where an instrument can be drawn back to from the goal, if that is far enough and the straight
/// motion from there is in the way of the mesh.
std::optional<RobotProblem> drawn_back(Scene& scene,
                                       const std::shared_ptr<const oracle::TriangleTree>& tree,
                                       const RobotUnderTest& robot, const RobotStart& goal,
                                       double margin, Random& random) {
  const Instrument instrument = robot.make(goal.base);
  // A period so long that limits of velocity do not slow it down.
  InstrumentConstraint guard = make_instrument_constraint(
      scene.mesh(), scene.shared_index(), instrument,
      {.options = {.margin = 2.1 * margin, .band = 0.1 * margin, .period = 0.1}});
  InstrumentConstraint straight = make_instrument_constraint(
      scene.mesh(), scene.shared_index(), instrument, {.options = {.margin = margin}});
  oracle::InstrumentOracle judge(tree, robot.judged(), goal.base);
  ChainState state;
  instrument.chain().place(goal.positions, state);
  const Pose last = state.flange();
  const Vec3 along = last.rotation.col(2);

  RobotProblem problem{.base = goal.base, .goal = goal.positions, .advance = least_advance};
  std::vector<double> q = goal.positions;
  Twist desired;
  for (int cycle = 1; cycle <= cycles_of_the_way; ++cycle) {
    if (cycle % heading_lasts == 1) {
      desired.linear = clipped(fastest_way * (random.direction() - 0.7 * along), fastest_way);
      desired.angular = random.uniform() * fastest_turn * random.direction();
    }
    const InstrumentStep step = guard.step(q, desired);
    for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += step.increment[k];
    instrument.chain().place(q, state);
    const double advance = along.dot(last.position - state.flange().position);
    if (cycle % looked_at_each != 0 || advance <= problem.advance + finer_than) continue;
    const std::array<std::vector<double>, 2> way{q, goal.positions};
    if (judge_joint_path(judge, straight, way).entering == 0) continue;
    problem.start = q;
    problem.advance = advance;
  }
  if (problem.start.empty()) return std::nullopt;
  return problem;
}

}  // namespace

std::vector<RobotProblem> draw_robot_problems(
    Scene& scene, const std::shared_ptr<const oracle::TriangleTree>& tree,
    const RobotUnderTest& robot, double margin, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<RobotProblem> problems;
  for (std::size_t i = 0; i < most_starts * count && problems.size() < count; ++i) {
    const auto goal = find_start(scene, tree, robot, Scenario::wedged, 2.1 * margin, random);
    if (!goal) break;
    std::optional<RobotProblem> problem = drawn_back(scene, tree, robot, *goal, margin, random);
    if (!problem) continue;
    problem->number = problems.size() + 1;
    problems.push_back(std::move(*problem));
  }
  if (problems.size() < count) {
    throw Error(
        scene.name() + ": only " + std::to_string(problems.size()) + " of " +
        std::to_string(count) + " problems were found for " + std::string(robot.name) +
        "; it needs walls near each other. Ask for fewer --problems, or for a smaller --margin");
  }
  return problems;
}

}  // namespace keepout::app
