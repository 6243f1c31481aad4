// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/ompl/joint_planning.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/robot/motion_bounds.h"
#include "operators/attacker.h"
#include "plan/planning.h"
#include "shared/robot_file.h"
#include "verify/robot/start.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;

constexpr int cycles_of_the_hand = 3000;
constexpr int looked_at_each = 20;         // [cycles]
constexpr double speed_of_the_hand = 4.0;  // see Attacker
constexpr double least_advance = 30;       // [mm]
constexpr double finer_than = 2.0;         // increments of the advance that are ignored [mm]
constexpr std::size_t most_starts = 100;   // for each requested problem

/// The oracle's judgement of a path of joint motions.
struct JointPathVerdict {
  std::size_t motions = 0;
  std::size_t too_close = 0;  // in which a body comes closer than margin - band - 3 tau
  std::size_t entering = 0;   // of these, motions in which the mesh penetrates a body
  std::size_t unproven = 0;   // motions that `prove` does not prove clear in pieces of 1 mm
  /// The least clearance of all bodies; below 0, how deep the mesh penetrates one. Infinite if no
  /// body came within the margin. [mm]
  double clearance = std::numeric_limits<double>::infinity();
};

constexpr double between_places = 0.05;  // longest displacement of a point between judged places
                                         // [mm]
constexpr double piece_length = 1.0;     // longest displacement that is proved at once [mm]

using Positions = std::vector<double>;

Positions between(const Positions& from, const Positions& to, double share) {
  Positions q = from;
  for (std::size_t k = 0; k < q.size(); ++k) q[k] += share * (to[k] - from[k]);
  return share == 1.0 ? to : q;
}

Positions increment(const Positions& from, const Positions& to) {
  Positions dq = to;
  for (std::size_t k = 0; k < dq.size(); ++k) dq[k] -= from[k];
  return dq;
}

/// Returns an upper bound of the path length of every point of a body. [mm]
double longest_way(const Instrument& instrument, const Positions& from, const Positions& to) {
  ChainState state;
  instrument.chain().forward_kinematics(from, state);
  double longest = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    const Vec3 at = state.at(point.link, point.position);
    longest = std::max(longest, motion_bounds(state, increment(from, to), point.link, at).path);
  }
  return longest;
}

/// Judges each motion between neighbors of `path` by the oracle, at places between which no point
/// of a body moves more than 0.05 mm. Also judges it by the guard's `prove`, in pieces.
JointPathVerdict judge_joint_path(oracle::InstrumentOracle& oracle, InstrumentConstraint& guard,
                                  std::span<const std::vector<double>> path) {
  JointPathVerdict verdict;
  const double margin = guard.options().margin;
  const double least = margin - guard.options().band - 3.0 * guard.tolerance();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Positions &from = path[i - 1], &to = path[i];
    const double way = longest_way(guard.instrument(), from, to);
    const auto in_steps_of = [way](double length) {
      return std::max(1.0, std::ceil(way / length));
    };

    double clearance = std::numeric_limits<double>::infinity();
    const double places = in_steps_of(between_places);
    for (double k = 0.0; k <= places; k += 1.0) {
      oracle.move_to(between(from, to, k / places));
      clearance = std::min(clearance, oracle.clearance(margin));
    }
    bool is_proven = true;
    const double pieces = in_steps_of(piece_length);
    for (double k = 0.0; k < pieces && is_proven; k += 1.0) {
      const Positions start = between(from, to, k / pieces);
      const Positions end = between(from, to, (k + 1.0) / pieces);
      is_proven = guard.prove(start, increment(start, end)).is_clear();
    }
    ++verdict.motions;
    verdict.too_close += clearance < least ? 1 : 0;
    verdict.entering += clearance < 0.0 ? 1 : 0;
    verdict.unproven += is_proven ? 0 : 1;
    verdict.clearance = std::min(verdict.clearance, clearance);
  }
  return verdict;
}

/// Returns the direction of the tool at a start: the z axis of the flange or, for the robot of a
/// URDF file, the axis of the last body.
Vec3 direction_of_tool(const RobotUnderTest& robot, const RobotStart& start, const Pose& flange) {
  if (!is_robot_file(robot.name)) return flange.rotation.col(2);
  const auto links = monitor::place(robot.judged(), start.base, start.positions);
  const monitor::Segment axis = axis_of(robot.judged().bodies.back(), links);
  const double length = (axis.to - axis.from).norm();
  return length > 0.0 ? Vec3((axis.to - axis.from) / length) : Vec3(flange.rotation.col(2));
}

/// Moves an instrument from a start by a simulated operator. Returns a problem if it gets far
/// enough and the straight motion there passes through the mesh.
std::optional<PlanningProblem> led_by_hand(RobotScene& on, const RobotStart& start,
                                           Random& random) {
  const Instrument instrument = on.robot.make(start.base);
  // The long period keeps velocity limits from slowing the operator down.
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
  const Vec3 along = direction_of_tool(on.robot, start, first);

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

/// All checkers use the same guards.
class InstrumentPlanning final : public Planning {
 public:
  InstrumentPlanning(const PlanOptions& options, Scene scene)
      : options_(&options),
        on_{std::move(scene), options.margin, chosen_robot(options.robot, options.bodies)} {}

  const Scene& scene() const override { return on_.scene; }

  /// Draws problems, each with a solution that maintains twice the margin:
  ///
  /// 1. The instrument starts 5 to 20 mm from a random place of the surface (find_start).
  /// 2. From there a simulated operator pushes, slides and turns it (Attacker), for 3000 certified
  ///    steps.
  /// 3. The goal is the place visited that is farthest ahead, along the tool's direction at the
  ///    start, to within about 2 mm. Only places count to which the straight joint motion passes
  ///    through the mesh. If the goal is less than 30 mm ahead, another start is tried.
  std::vector<PlanningProblem> draw(const StopSignal& stop) override {
    Random random(options_->seed);
    const std::size_t count = options_->problems;
    std::vector<PlanningProblem> problems;
    for (std::size_t i = 0; i < most_starts * count && problems.size() < count; ++i) {
      // The operator starts with more than the required margin.
      const auto start = on_.start(random, 2.1);
      if (!start) break;
      if (stop.has_come()) return problems;
      std::optional<PlanningProblem> problem = led_by_hand(on_, *start, random);
      if (!problem) continue;
      problem->number = problems.size() + 1;
      problems.push_back(std::move(*problem));
    }
    if (problems.size() == count) return problems;
    throw Error(scene().name() + ": only " + std::to_string(problems.size()) + " of " +
                std::to_string(count) + " problems were found for " + on_.robot.name +
                "; ask for fewer --problems, or for a smaller --margin");
  }

  void open(const PlanningProblem& problem) override {
    guards_ = std::make_shared<InstrumentPool>([this, base = problem.base] {
      return make_instrument_constraint(scene().mesh(), scene().shared_index(),
                                        on_.robot.make(base), {.options = {.margin = on_.margin}});
    });
    oracle_.emplace(on_.scene.tree(), on_.robot.judged(), problem.base);
  }

  base::StateSpacePtr space() const override {
    return make_joint_space(guards_->borrow()->instrument());
  }

  Checks checks(const base::SpaceInformationPtr& space, const Checker& checker) override {
    return {make_state_validity_checker(space, guards_),
            checker.is_keepouts() ? make_motion_validator(space, guards_) : nullptr};
  }

  Json judge(const Path& path) override {
    const JointPathVerdict verdict = judge_joint_path(*oracle_, *guards_->borrow(), path);
    base::ScopedState<> a(space()), b(a);
    double length = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      a = path[i - 1];
      b = path[i];
      length += a.distance(b);
    }
    return {{"motions", verdict.motions},
            {"too_close", verdict.too_close},
            {"entering", verdict.entering},
            {"unproven", verdict.unproven},
            {"clearance_mm", or_null(verdict.clearance)},
            {"length_mm", length},
            {"path", path}};
  }

 private:
  const PlanOptions* options_;
  RobotScene on_;
  std::shared_ptr<InstrumentPool> guards_;
  std::optional<oracle::InstrumentOracle> oracle_;
};

}  // namespace

std::unique_ptr<Planning> planning_of_an_instrument(const PlanOptions& options, Scene scene) {
  return std::make_unique<InstrumentPlanning>(options, std::move(scene));
}

}  // namespace keepout::app
