// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/instrument_proxy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

const HapticOptions& checked(const HapticOptions& options, const InstrumentConstraint& guard) {
  check(options);
  if (!options.guides.empty()) {
    throw Error(
        "instrument proxy: guides: expected none; give them to InstrumentConstraint::set_guides");
  }
  if (options.period != guard.options().period) {
    throw Error("instrument proxy: period: expected that of the instrument's options");
  }
  const Chain& chain = guard.instrument().chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const JointLimits& limits = chain.joint(k).limits;
    if (std::isfinite(std::min(limits.velocity, limits.increment))) continue;
    throw Error("instrument proxy: joint '" + chain.joint(k).name + "' (" + std::to_string(k) +
                ") has no limit of its velocity or increment: a goal that jumps would move it at "
                "once");
  }
  return options;
}

/// Returns true if there is a finite number for each joint.
bool are_positions(std::span<const double> q, const Chain& chain) noexcept {
  return q.size() == static_cast<std::size_t>(chain.size()) &&
         std::ranges::all_of(q, [](double number) { return std::isfinite(number); });
}

/// Returns the rotation from one orientation to another: axis times angle. [rad]
Vec3 rotation_between(const Mat3& from, const Mat3& to) noexcept {
  const Eigen::AngleAxisd turn(Mat3(to * from.transpose()));
  return turn.angle() * turn.axis();
}

}  // namespace

InstrumentProxy::InstrumentProxy(InstrumentConstraint guard, const HapticOptions& options)
    : guard_(std::move(guard)), options_(checked(options, guard_)), force_(options_) {
  InstrumentOptions slowed = guard_.options();
  slowed.recovery = std::min(slowed.recovery, options.top_speed * options.period);
  guard_.set_options(slowed);
}

CycleStatus InstrumentProxy::engage(std::span<const double> q) noexcept {
  release();
  if (!are_positions(q, chain())) return CycleStatus::invalid_pose;
  std::ranges::copy(q, positions_.begin());
  flange_ = flange_at(q);
  guard_.forget();
  force_.engage(flange_.position);
  engaged_ = true;
  return CycleStatus::guarded;
}

void InstrumentProxy::release() noexcept {
  force_.release();
  engaged_ = false;
}

void InstrumentProxy::place(const Pose& pose) noexcept {
  release();
  for (std::size_t m = 0; m < guard_.mesh_count(); ++m) guard_.place(m, pose);
}

void InstrumentProxy::follow(std::shared_ptr<const Mesh> mesh,
                             std::shared_ptr<const SpatialIndex> index) {
  guard_.follow(std::move(mesh), std::move(index));
  release();
}

HapticCycle InstrumentProxy::cycle(const Pose& goal) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  if (!goal.rotation.allFinite()) return stand(CycleStatus::invalid_pose);
  Twist wanted{.linear = goal.position - flange_.position,
               .angular = rotation_between(flange_.rotation, goal.rotation)};
  const double distance = wanted.linear.norm();
  if (!(distance <= options_.farthest)) return stand(CycleStatus::too_far);
  const double longest = options_.top_speed * options_.period;
  const double size =
      std::hypot(distance, guard_.options().orientation_weight * wanted.angular.norm());
  if (size > longest) {
    wanted.linear *= longest / size;
    wanted.angular *= longest / size;
  }
  const InstrumentStep step = guard_.step(positions(), wanted);
  if (step.ok()) {
    move(step);
    force_.follow(goal.position, flange_.position);
  } else {
    force_.fade(goal.position);
  }
  return finish(step);
}

HapticCycle InstrumentProxy::cycle(std::span<const double> goal) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  if (!are_positions(goal, chain())) return stand(CycleStatus::invalid_pose);
  const Vec3 hand = flange_at(goal).position;
  if (!((hand - flange_.position).norm() <= options_.farthest)) {
    return stand(CycleStatus::too_far);
  }
  std::array<double, Chain::most_joints> increment;
  for (std::size_t k = 0; k < goal.size(); ++k) increment[k] = goal[k] - positions_[k];
  const InstrumentStep step = guard_.step(positions(), std::span(increment).first(goal.size()));
  if (step.ok()) {
    move(step);
    force_.follow(hand, flange_.position);
  } else {
    force_.fade(hand);
  }
  return finish(step);
}

HapticCycle InstrumentProxy::move_by(std::span<const double> increment) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  if (!are_positions(increment, chain())) return stand(CycleStatus::invalid_pose);
  const InstrumentStep step = guard_.step(positions(), increment);
  force_.fade();
  if (step.ok()) move(step);
  return finish(step);
}

void InstrumentProxy::move(const InstrumentStep& step) noexcept {
  for (std::size_t k = 0; k < step.increment.size(); ++k) positions_[k] += step.increment[k];
  flange_ = flange_at(positions());
}

HapticCycle InstrumentProxy::stand(CycleStatus why) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  force_.fade();
  return finish(why, Status::invalid_input);
}

HapticCycle InstrumentProxy::stand(CycleStatus why, const Vec3& hand) noexcept {
  if (!((hand - flange_.position).norm() <= options_.farthest)) return stand(why);
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  force_.fade(hand);
  return finish(why, Status::invalid_input);
}

Pose InstrumentProxy::flange_at(std::span<const double> q) const noexcept {
  ChainState state;
  chain().forward_kinematics(q, state);
  return state.flange();
}

double InstrumentProxy::lag(std::span<const double> q) const noexcept {
  ChainState here;
  ChainState there;
  chain().forward_kinematics(positions(), here);
  chain().forward_kinematics(q, there);
  double largest = (there.flange().position - flange_.position).norm();
  for (const LinkPoint& point : guard_.instrument().points()) {
    const Vec3 way = there.at(point.link, point.position) - here.at(point.link, point.position);
    largest = std::max(largest, way.norm());
  }
  return largest;
}

HapticCycle InstrumentProxy::finish(const InstrumentStep& step) const noexcept {
  HapticCycle cycle = finish(step.ok() ? CycleStatus::guarded : CycleStatus::stopped, step.status);
  cycle.limits = step.limits;
  return cycle;
}

HapticCycle InstrumentProxy::finish(CycleStatus status, Status step) const noexcept {
  return {.status = status,
          .step = step,
          .proxy = flange_.position,
          .force = force_.force(),
          .subject = Subject::instrument};
}

}  // namespace keepout
