// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/haptic_proxy.h"

#include <algorithm>
#include <array>
#include <utility>

#include "require_number.h"

namespace keepout {
namespace {

/// Name and reason of each CycleStatus, in its order.
constexpr std::array<std::array<std::string_view, 2>, 8> outcomes{{
    {"guarded", "the proxy followed as far as the mesh allows"},
    {"not_engaged", "not engaged; call engage() with the position of the robot's tip"},
    {"invalid_pose",
     "a pose is not finite, or not a rotation; check the message that it came from"},
    {"too_far", "the goal is too far from the proxy; check its unit, or engage anew after a jump"},
    {"stale", "no goal came for too long; check the connection and the rate of the sender"},
    {"lagging", "the robot is too far from the setpoint; wait for it, or check what blocks it"},
    {"far_from_mesh",
     "the tip is implausibly far from the mesh; check the registration and its units"},
    {"stopped", "the engine refused the step; see its status"},
}};

std::string_view text_of(CycleStatus status, std::size_t column) noexcept {
  const auto at = static_cast<std::size_t>(status);
  return at < outcomes.size() ? outcomes[at][column] : "unknown";
}

constexpr double longest_length = 1e30;  // as for the engine's lengths

bool is_place(const Vec3& point) noexcept {
  // A NaN fails the comparison or allFinite().
  return point.cwiseAbs().maxCoeff() <= longest_length && point.allFinite();
}

const HapticOptions& checked(const HapticOptions& options) {
  check(options.spring);
  require_number("haptic proxy: period, in seconds", options.period, {1e-6, 1.0});
  require_number("haptic proxy: top_speed", options.top_speed, above_zero(longest_length));
  require_number("haptic proxy: farthest", options.farthest, above_zero(longest_length));
  require_number("haptic proxy: fade, from one period on", options.fade, {options.period, 10.0});
  require_number("haptic proxy: largest_brake", options.largest_brake, {0.0, longest_length});
  return options;
}

}  // namespace

std::string_view name(CycleStatus status) noexcept { return text_of(status, 0); }

std::string_view reason(CycleStatus status) noexcept { return text_of(status, 1); }

HapticProxy::HapticProxy(MotionConstraint guard, const HapticOptions& options)
    : guard_(std::move(guard)),
      options_(checked(options)),
      longest_(std::min(options.top_speed * options.period, guard_.options().radius)),
      passivity_(options.largest_brake) {
  StepOptions slowed = guard_.options();
  slowed.recovery = std::min(slowed.recovery, longest_);
  guard_.set_options(slowed);
  guard_.set_guides(options.guides);
}

CycleStatus HapticProxy::engage(const Vec3& tip) noexcept {
  release();
  if (!is_place(tip)) return CycleStatus::invalid_pose;
  energy_ = {};
  proxy_ = hand_ = tip;
  engaged_ = seen_ = true;
  return CycleStatus::guarded;
}

void HapticProxy::release() noexcept {
  passivity_.restart();
  held_ = {};
  hand_way_ = Vec3::Zero();
  stretch_ = 0.0;
  share_ = 1.0;
  engaged_ = seen_ = false;
}

HapticCycle HapticProxy::cycle(const Vec3& hand) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  if (!is_place(hand)) return stand(CycleStatus::invalid_pose);
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
  const Vec3 before = proxy_;
  proxy_ = arrives ? hand : Vec3(proxy_ + fraction * step.motion);
  fade(1.0);
  book(hand, proxy_ - before);
  update_force();
  HapticCycle guarded = finish(CycleStatus::guarded, step.status);
  guarded.limits = step.limits;
  return guarded;
}

HapticCycle HapticProxy::stand(CycleStatus why, const Vec3& hand) noexcept {
  if (!is_place(hand) || !((hand - proxy_).norm() <= options_.farthest)) return stand(why);
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  fade(0.0);
  book(hand, Vec3::Zero());
  update_force();
  return finish(why, Status::invalid_input);
}

HapticCycle HapticProxy::stand(CycleStatus why) noexcept {
  if (!engaged_) return finish(CycleStatus::not_engaged, Status::invalid_input);
  const double before = share_;
  fade(0.0);
  held_.spring *= before > 0.0 ? share_ / before : 0.0;
  held_.brake = Vec3::Zero();
  energy_.book_blind(share_ * options_.spring.stored(stretch_));
  seen_ = false;
  return finish(why, Status::invalid_input);
}

void HapticProxy::fade(double towards) noexcept {
  const double change = options_.period / options_.fade;
  share_ = towards > share_ ? std::min(share_ + change, 1.0) : std::max(share_ - change, towards);
}

void HapticProxy::book(const Vec3& hand, const Vec3& proxy_way) noexcept {
  const double stretch = (proxy_ - hand).norm();
  const double stored = share_ * options_.spring.stored(stretch);
  rate_ = 0.0;
  hand_way_ = Vec3::Zero();
  if (seen_) {
    hand_way_ = hand - hand_;
    rate_ = (stretch - stretch_) / options_.period;
    passivity_.observe(held_.total(), hand_way_);
    energy_.book(held_, hand_way_, proxy_way, stored);
    energy_.active = std::max(energy_.active, -passivity_.energy());
  } else {
    energy_.book_blind(stored);
  }
  hand_ = hand;
  stretch_ = stretch;
  seen_ = true;
}

void HapticProxy::update_force() noexcept {
  const double newtons_before = held_.spring.norm();
  held_ = {};
  if (!(stretch_ > 0.0)) {
    passivity_.leave_contact();
    return;
  }
  const SpringDamper& spring = options_.spring;
  const double newtons = std::min(share_ * spring.force(stretch_, rate_),
                                  newtons_before + spring.largest_rise * options_.period);
  held_.spring = (newtons / stretch_) * (proxy_ - hand_);
  held_.brake = share_ * passivity_.brake(hand_way_, options_.period);
  const double total = held_.total().norm();
  if (total > spring.largest_force) {
    held_.spring *= spring.largest_force / total;
    held_.brake *= spring.largest_force / total;
  }
  energy_.largest_force = std::max(energy_.largest_force, held_.total().norm());
}

HapticCycle HapticProxy::finish(CycleStatus status, Status step) const noexcept {
  return {.status = status, .step = step, .proxy = proxy_, .force = held_.total()};
}

}  // namespace keepout
