// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/haptic_proxy.h"

#include <algorithm>
#include <utility>

namespace keepout {
namespace {

bool is_position(const Vec3& point) noexcept {
  // A NaN fails the comparison or allFinite().
  return point.cwiseAbs().maxCoeff() <= 1e30 && point.allFinite();
}

const HapticOptions& checked(const HapticOptions& options) {
  check(options);
  return options;
}

}  // namespace

HapticProxy::HapticProxy(MotionConstraint guard, const HapticOptions& options)
    : guard_(std::move(guard)),
      options_(checked(options)),
      longest_(std::min(options.top_speed * options.period, guard_.options().radius)),
      force_(options_) {
  StepOptions slowed = guard_.options();
  slowed.recovery = std::min(slowed.recovery, longest_);
  guard_.set_options(slowed);
  if (!options.guides.empty()) guard_.set_guides(options.guides);
}

CycleStatus HapticProxy::engage(const Vec3& tip) noexcept {
  release();
  if (!is_position(tip)) return CycleStatus::invalid_pose;
  proxy_ = tip;
  force_.engage(tip);
  engaged_ = true;
  return CycleStatus::guarded;
}

void HapticProxy::release() noexcept {
  force_.release();
  engaged_ = false;
}

void HapticProxy::follow(std::shared_ptr<const Mesh> mesh,
                         std::shared_ptr<const SpatialIndex> index) {
  guard_.follow(std::move(mesh), std::move(index));
  release();
}

HapticCycle HapticProxy::cycle(const Vec3& hand) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  if (!is_position(hand)) return stand(CycleStatus::invalid_pose);
  const Vec3 wanted = hand - proxy_;
  const double distance = wanted.norm();
  if (!(distance <= options_.farthest)) return stand(CycleStatus::too_far);

  const double radius = guard_.options().radius;
  const bool is_cut = distance > radius;
  Motion motion{.tip = proxy_, .desired = wanted};
  if (is_cut) motion.desired *= radius / distance;
  const Step step = guard_.step(motion);
  guide_states_ = step.guides;
  if (!step.ok()) {
    HapticCycle stood = stand(CycleStatus::stopped, hand);
    stood.step = step.status;
    return stood;
  }
  // The top speed shortens the motion that was found, not the desired one: that would slow down an
  // operator who presses into the surface and slides. Any part of a proved motion is proved as
  // well. An escape from inside is not proved, but is no longer than the recovery, which the
  // constructor limits to `longest_`.
  const double fraction = std::min(1.0, longest_ / step.motion.norm());  // 1 for zero motion
  // A free motion ends exactly at the goal: no force is left in free space.
  const bool arrives = !is_cut && fraction == 1.0 && step.motion == motion.desired;
  proxy_ = arrives ? hand : Vec3(proxy_ + fraction * step.motion);
  force_.follow(hand, proxy_);
  HapticCycle guarded = finish(CycleStatus::guarded, step.status);
  guarded.limits = step.limits;
  return guarded;
}

HapticCycle HapticProxy::stand(CycleStatus why, const Vec3& hand) noexcept {
  if (!is_position(hand) || !((hand - proxy_).norm() <= options_.farthest)) return stand(why);
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  force_.fade(hand);
  return finish(why, Status::invalid_input);
}

HapticCycle HapticProxy::stand(CycleStatus why) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  force_.fade();
  return finish(why, Status::invalid_input);
}

HapticCycle HapticProxy::finish(CycleStatus status, Status step) const noexcept {
  return {.status = status, .step = step, .proxy = proxy_, .force = force_.force()};
}

}  // namespace keepout
