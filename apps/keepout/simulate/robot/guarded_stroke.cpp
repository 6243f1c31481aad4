// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/robot/guarded_stroke.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/solvers/active_set.h"
#include "shared/clip.h"
#include "verify/robot/hand.h"

namespace keepout::app {
namespace {

/// From where the flange is to where the hand would have it, as far as a cycle goes.
Twist way_to(const Pose& goal, const Pose& at, double speed) {
  const Eigen::AngleAxisd turn(Mat3(goal.rotation * at.rotation.transpose()));
  return {.linear = clipped(goal.position - at.position, speed * fastest_way),
          .angular = clipped(turn.angle() * turn.axis(), speed * fastest_turn)};
}

/// The step of all modes, which differ in what it keeps out of: of nothing where only the tip is
/// guarded, or nothing is. Then it is the damped least squares within the joints' limits.
InstrumentConstraint joints_of(Mode mode, Scene& scene, const Instrument& instrument,
                               InstrumentOptions options) {
  if (mode == Mode::linearised) options.certified = CertifiedMotion::linearised;
  InstrumentConstraint joints(instrument, std::make_unique<ActiveSet>(), options);
  if (mode == Mode::certified || mode == Mode::linearised) {
    joints.add_mesh(scene.mesh(), scene.shared_index());
  }
  return joints;
}

}  // namespace

std::string_view name(Mode mode) noexcept {
  constexpr std::array<std::string_view, 4> names{"certified", "linearised", "tip only", "none"};
  return names[static_cast<std::size_t>(mode)];
}

std::vector<GuardedCycle> follow(const RobotStroke& stroke, RobotScene& on, Random random,
                                 ModeTally& tally) {
  const Instrument instrument = on.robot.make(stroke.start.base);
  const Chain& chain = instrument.chain();
  const InstrumentOptions options = options_of({.margin = on.margin}, chain, tally.speed);
  InstrumentConstraint joints = joints_of(tally.mode, on.scene, instrument, options);
  std::optional<MotionConstraint> tip;  // a ball at the end of the jaw
  if (tally.mode == Mode::tip_only) {
    tip = make_motion_constraint(on.scene.mesh(), on.scene.shared_index(),
                                 {.options = {.radius = 10.0 * tally.speed,
                                              .tool_radius = instrument.bodies().back().radius,
                                              .margin = on.margin}});
  }
  std::vector<double> q = stroke.start.positions;
  oracle::RobotJudge judge({on.robot.judged(), stroke.start.base, {{on.scene.tree()}}}, chain,
                           random, q, options, joints.tolerance());
  const double kept = on.margin - options.band - 3.0 * joints.tolerance();
  std::vector<GuardedCycle> cycles;
  for (const Pose& goal : stroke.hand) {
    ChainState state;
    chain.forward_kinematics(q, state);
    Twist asked = way_to(goal, state.flange(), tally.speed);
    if (tip)
      asked.linear = tip->step({.tip = state.flange().position, .desired = asked.linear}).motion;
    const InstrumentStep step = joints.step(q, asked);
    for (std::size_t k = 0; step.ok() && k < q.size(); ++k) q[k] += step.increment[k];
    const oracle::RobotVerdict verdict = judge.judge(q);
    ++tally.cycles;
    tally.refused += step.ok() ? 0 : 1;
    tally.limits_broken += verdict.limits_broken ? 1 : 0;
    const auto add = [&](BodyTally& body, double least) {
      body.below += least >= kept ? 0 : 1;
      body.in_mesh += least < 0.0 ? 1 : 0;
      body.deepest = std::max(body.deepest, -least);
    };
    add(tally.any, verdict.least);
    GuardedCycle& cycle = cycles.emplace_back();
    for (std::size_t b = 0; b < body_names.size(); ++b) {
      cycle.clearances[b] = judge.least()[b];
      cycle.places[b] = judge.oracle().axis(b).to;
      add(tally.bodies[b], cycle.clearances[b]);
    }
  }
  return cycles;
}

}  // namespace keepout::app
