// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/crtk_guard.h"

#include <limits>
#include <utility>

#include "keepout/error.h"
#include "require_number.h"

namespace keepout {
namespace {

const CrtkOptions& checked(const CrtkOptions& options) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  require_number("CRTK guard: motion_scale", options.motion_scale, above_zero(1e3));
  if (!is_rotation(options.hand_from_robot)) {
    throw Error("CRTK guard: hand_from_robot must be a rotation: no reflection, no scale");
  }
  require_number("CRTK guard: longest_silence", options.longest_silence, {0.0, infinity});
  require_number("CRTK guard: farthest_lag", options.farthest_lag, above_zero(infinity));
  require_number("CRTK guard: farthest_start", options.farthest_start, above_zero(infinity));
  return options;
}

}  // namespace

CrtkGuard::CrtkGuard(MotionConstraint guard, const Registration& registration,
                     const CrtkOptions& options)
    : proxy_(std::move(guard), options.haptic),
      registration_(registration),
      options_(checked(options)) {
  options_.hand_from_robot =
      nearest_rotation(options_.hand_from_robot);  // preserves the size of forces
}

CycleStatus CrtkGuard::engage(const Pose& setpoint) noexcept {
  release();
  if (!is_valid(setpoint)) return cycle_.status = CycleStatus::invalid_pose;
  const Vec3 tip = registration_.point_to_mesh(setpoint.position);
  if (!(distance_to(proxy_.mesh().bounds(), tip) <= options_.farthest_start)) {
    return cycle_.status = CycleStatus::far_from_mesh;
  }
  cycle_.status = proxy_.engage(tip);
  if (is_ok(cycle_.status)) {
    cycle_.step = Status::free;
    cycle_.proxy = tip;
    setpoint_ = goal_ = setpoint;
  }
  return cycle_.status;
}

void CrtkGuard::release() noexcept {
  proxy_.release();
  setpoint_.reset();
  wrench_ = {};
  cycle_ = {};
  measured_.reset();
  silence_ = 0.0;
}

void CrtkGuard::set_registration(const Registration& registration) noexcept {
  release();
  registration_ = registration;
}

CycleStatus CrtkGuard::servo_cp(const Pose& goal) noexcept {
  silence_ = 0.0;
  goal_ = goal;
  return go();
}

CycleStatus CrtkGuard::await_cp() noexcept {
  silence_ += proxy_.options().period;
  return go();
}

CycleStatus CrtkGuard::go() noexcept {
  const std::optional<Pose> measured = std::exchange(measured_, std::nullopt);
  // The factor allows for the rounding of the sum.
  if (silence_ > options_.longest_silence * (1.0 + 1e-9)) {
    return take(proxy_.stand(CycleStatus::stale));
  }
  if (!is_valid(goal_) || (measured && !is_valid(*measured))) {
    return take(proxy_.stand(CycleStatus::invalid_pose));
  }
  const Vec3 hand = registration_.point_to_mesh(goal_.position);
  if (measured) {
    const Vec3 lag = registration_.point_to_mesh(measured->position) - proxy_.proxy();
    if (!(lag.norm() <= options_.farthest_lag)) {
      return take(proxy_.stand(CycleStatus::lagging, hand));
    }
  }
  return take(proxy_.cycle(hand));
}

CycleStatus CrtkGuard::take(const HapticCycle& cycle) noexcept {
  cycle_ = cycle;
  if (cycle.ok()) setpoint_ = Pose{registration_.point_to_robot(cycle.proxy), goal_.rotation};
  wrench_.force = options_.motion_scale *
                  (options_.hand_from_robot * registration_.force_to_robot(cycle.force));
  return cycle.status;
}

}  // namespace keepout
