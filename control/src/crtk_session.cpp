// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/crtk_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/error.h"
#include "require_number.h"

namespace keepout {
namespace {

constexpr std::array<std::string_view, 4> state_names{"DISABLED", "ENABLED", "PAUSED", "FAULT"};

/// Throws Error for a length beyond any robot, as a default in mm for a mesh in meters.
void require_plausible(const CrtkOptions& options, const Registration& registration) {
  if (registration.mesh_unit() != LengthUnit::metre) return;
  const auto require = [](std::string_view name, double value, double most) {
    if (value <= most) return;
    throw Error("CRTK session: " + std::string(name) + ": " + std::to_string(value) +
                " with a mesh in meters: expected at most " + std::to_string(most) +
                "; the defaults are for a mesh in mm");
  };
  require("top_speed [m/s]", options.haptic.top_speed, 10.0);
  require("farthest [m]", options.haptic.farthest, 1.0);
  require("farthest_lag [m]", options.farthest_lag, 1.0);
  require("farthest_start [m]", options.farthest_start, 10.0);
}

/// Returns a pose of the robot's frame in another unit.
Pose in_unit(const Pose& pose, double scale) noexcept {
  return {scale * pose.position, pose.rotation};
}

MotionConstraint of_ball(MotionConstraint guard) {
  if (!guard.guards_a_tool()) return guard;
  throw Error(
      "CRTK session: the constraint guards a convex tool, which would not turn with the robot; "
      "use a ball (tool_radius), or the session of an instrument");
}

CrtkOptions checked(CrtkOptions options, const Registration& registration) {
  require_plausible(options, registration);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  require_number("CRTK session: motion_scale", options.motion_scale, above_zero(1e3));
  if (!is_rotation(options.hand_from_robot)) {
    throw Error("CRTK session: hand_from_robot must be a rotation: no reflection, no scale");
  }
  require_number("CRTK session: longest_silence", options.longest_silence, {0.0, infinity});
  require_number("CRTK session: farthest_lag", options.farthest_lag, above_zero(infinity));
  require_number("CRTK session: farthest_start", options.farthest_start, above_zero(infinity));
  // An exact rotation preserves the size of forces.
  options.hand_from_robot = nearest_rotation(options.hand_from_robot);
  return options;
}

}  // namespace

std::string_view name(OperatingState state) noexcept {
  const auto at = static_cast<std::size_t>(state);
  return at < state_names.size() ? state_names[at] : "unknown";
}

std::optional<OperatingState> operating_state_of(std::string_view name) noexcept {
  const auto found = std::ranges::find(state_names, name);
  if (found == state_names.end()) return std::nullopt;
  return static_cast<OperatingState>(found - state_names.begin());
}

CrtkSession::CrtkSession(MotionConstraint guard, const Registration& registration,
                         const CrtkOptions& options)
    : proxy_(std::in_place_type<HapticProxy>, of_ball(std::move(guard)), options.haptic),
      registration_(registration),
      options_(checked(options, registration)) {}

CrtkSession::CrtkSession(InstrumentConstraint guard, const Registration& registration,
                         const CrtkOptions& options)
    : proxy_(std::in_place_type<InstrumentProxy>, std::move(guard), options.haptic),
      registration_(registration),
      options_(checked(options, registration)) {
  set_registration(registration);
}

void CrtkSession::on_operating_state(OperatingState state, bool is_homed) noexcept {
  robot_state_ = state;
  is_homed_ = is_homed;
}

void CrtkSession::on_measured_cp(const Pose& pose, const MessageHeader& header) noexcept {
  if (tip() == nullptr) return;
  measured_stamp_ = never;
  if (!is_accepted(pose, header)) return;
  measured_ = pose;
  measured_stamp_ = header.stamp;
}

void CrtkSession::on_measured_js(std::span<const double> positions,
                                 const MessageHeader& header) noexcept {
  if (instrument() == nullptr) return;
  measured_stamp_ = never;
  if (!take(positions, measured_joints_)) return;
  measured_ = in_unit(instrument()->flange_at(all(measured_joints_)), 1.0 / registration_.scale());
  measured_stamp_ = header.stamp;
}

void CrtkSession::on_setpoint_cp(const Pose& pose, const MessageHeader& header) noexcept {
  if (tip() == nullptr) return;
  start_stamp_ = is_accepted(pose, header) ? header.stamp : never;
  start_ = pose;
}

void CrtkSession::on_setpoint_js(std::span<const double> positions,
                                 const MessageHeader& header) noexcept {
  if (instrument() == nullptr) return;
  start_stamp_ = take(positions, start_joints_) ? header.stamp : never;
}

void CrtkSession::on_servo_cp(const Pose& goal, const MessageHeader& header) noexcept {
  if (!is_accepted(goal, header)) return;
  command_ = Command::pose;
  goal_ = goal;
  goal_stamp_ = header.stamp;
}

void CrtkSession::on_servo_jp(std::span<const double> goal, const MessageHeader& header) noexcept {
  receive_joints(goal, header.stamp, Command::positions);
}

void CrtkSession::on_servo_jv(std::span<const double> velocity,
                              const MessageHeader& header) noexcept {
  receive_joints(velocity, header.stamp, Command::velocities);
}

void CrtkSession::receive_joints(std::span<const double> numbers, double stamp,
                                 Command command) noexcept {
  if (instrument() == nullptr) return refuse(CycleStatus::wrong_command);
  if (!take(numbers, goal_joints_)) return;
  command_ = command;
  goal_stamp_ = stamp;
}

void CrtkSession::refuse(CycleStatus why) noexcept {
  if (is_ok(refusal_)) refusal_ = why;  // the first cause is reported
}

bool CrtkSession::is_accepted(const Pose& pose, const MessageHeader& header) noexcept {
  if (!options_.frame.empty() && !header.frame.empty() && header.frame != options_.frame) {
    refuse(CycleStatus::other_frame);
    return false;
  }
  if (!is_valid(pose)) {
    refuse(CycleStatus::invalid_pose);
    return false;
  }
  return true;
}

bool CrtkSession::take(std::span<const double> numbers, Positions& joints) noexcept {
  if (numbers.size() != static_cast<std::size_t>(instrument()->chain().size())) {
    refuse(CycleStatus::wrong_command);
    return false;
  }
  Positions scaled{};
  for (std::size_t k = 0; k < numbers.size(); ++k) scaled[k] = scale_of(k) * numbers[k];
  if (!std::ranges::all_of(scaled, [](double number) { return std::isfinite(number); })) {
    refuse(CycleStatus::invalid_pose);
    return false;
  }
  joints = scaled;
  return true;
}

std::span<const double> CrtkSession::all(const Positions& joints) const noexcept {
  return {joints.data(), static_cast<std::size_t>(instrument()->chain().size())};
}

double CrtkSession::scale_of(std::size_t joint) const noexcept {
  const bool slides =
      instrument()->chain().joint(static_cast<int>(joint) + 1).kind == JointKind::prismatic;
  return slides ? registration_.scale() : 1.0;
}

Vec3 CrtkSession::position_of(const Pose& pose) const noexcept {
  return tip() != nullptr ? registration_.point_to_mesh(pose.position)
                          : Vec3(registration_.scale() * pose.position);
}

bool CrtkSession::is_ready() const noexcept {
  if (!robot_state_) return !options_.needs_feedback;
  return robot_state_ == OperatingState::enabled && is_homed_;
}

bool CrtkSession::is_fresh(double stamp, double now) const noexcept {
  // The factor allows for the rounding of sums of periods. A mailbox without a message is not fresh
  // for an infinite silence either.
  return std::isfinite(stamp) && std::abs(now - stamp) <= options_.longest_silence * (1.0 + 1e-9);
}

CycleStatus CrtkSession::engage(double now) noexcept {
  const CycleStatus refusal = refusal_;
  release();
  if (!is_ready()) return cycle_.status = CycleStatus::not_ready;
  if (is_contested_) return cycle_.status = CycleStatus::contested;
  if (!is_ok(refusal)) return cycle_.status = refusal;
  // An older message says where the robot was before it followed the last setpoint. Unless the
  // clock was set back since.
  const bool is_older = start_stamp_ < sent_ && sent_ <= now;
  if (!is_fresh(start_stamp_, now) || is_older) {
    return cycle_.status = CycleStatus::unmeasured;
  }
  if (instrument() != nullptr) {
    start_ = in_unit(instrument()->flange_at(all(start_joints_)), 1.0 / registration_.scale());
  }
  const Vec3 position = registration_.point_to_mesh(start_.position);
  const Mesh* mesh = first_mesh();
  if (mesh != nullptr && !(distance_to(mesh->bounds(), position) <= options_.farthest_start)) {
    return cycle_.status = CycleStatus::far_from_mesh;
  }
  HapticCycle engaged{.step = Status::free, .proxy = position_of(start_)};
  if (auto* const moved = std::get_if<HapticProxy>(&proxy_)) {
    engaged.status = moved->engage(position);
  } else {
    engaged.status = std::get<InstrumentProxy>(proxy_).engage(all(start_joints_));
  }
  if (!is_ok(engaged.status)) return cycle_.status = engaged.status;
  command_ = Command::pose;
  goal_ = start_;
  goal_stamp_ = now;
  finish(engaged);
  setpoint_ = start_;  // bitwise
  return engaged.status;
}

void CrtkSession::release() noexcept {
  std::visit([](auto& proxy) { proxy.release(); }, proxy_);
  setpoint_.reset();
  wrench_ = {};
  cycle_ = {};
  refusal_ = CycleStatus::guarded;
}

void CrtkSession::set_registration(const Registration& registration) noexcept {
  release();
  measured_stamp_ = start_stamp_ = goal_stamp_ = never;
  registration_ = registration;
  if (auto* const moved = std::get_if<InstrumentProxy>(&proxy_)) {
    moved->place(registration.mesh_in_robot());
  }
}

void CrtkSession::set_mesh(std::shared_ptr<const Mesh> mesh,
                           std::shared_ptr<const SpatialIndex> index) {
  std::visit([&](auto& proxy) { proxy.follow(std::move(mesh), std::move(index)); }, proxy_);
  release();
}

CycleStatus CrtkSession::tick(double now) noexcept {
  const CycleStatus refusal = std::exchange(refusal_, CycleStatus::guarded);
  if (!is_ready()) {
    release();
    return cycle_.status = CycleStatus::not_ready;
  }
  if (!engaged()) return cycle_.status = CycleStatus::not_engaged;
  sent_ = now;
  if (is_contested_) return finish(stand(CycleStatus::contested));
  if (!is_ok(refusal)) return finish(stand(refusal));
  if (!is_fresh(goal_stamp_, now)) return finish(stand(CycleStatus::stale));
  if (is_fresh(measured_stamp_, now)) {
    if (!(lag() <= options_.farthest_lag)) return finish(stand(CycleStatus::lagging));
  } else if (options_.needs_feedback) {
    return finish(stand(CycleStatus::unmeasured));
  }
  return finish(move());
}

double CrtkSession::lag() const noexcept {
  if (instrument() != nullptr) return instrument()->lag(all(measured_joints_));
  return (position_of(*measured_) - position_of(*setpoint_)).norm();
}

const Mesh* CrtkSession::first_mesh() const noexcept {
  if (tip() != nullptr) return &tip()->mesh();
  const InstrumentConstraint& guard = instrument()->guard();
  return guard.mesh_count() > 0 ? &guard.mesh() : nullptr;
}

HapticCycle CrtkSession::move() noexcept {
  if (auto* const moved = std::get_if<HapticProxy>(&proxy_)) {
    return moved->cycle(position_of(goal_));
  }
  auto& moved = std::get<InstrumentProxy>(proxy_);
  switch (command_) {
    case Command::pose:
      return moved.cycle(in_unit(goal_, registration_.scale()));
    case Command::positions:
      return moved.cycle(all(goal_joints_));
    case Command::velocities:
      break;
  }
  Positions increment = {};
  for (std::size_t k = 0; k < all(goal_joints_).size(); ++k) {
    increment[k] = options_.haptic.period * goal_joints_[k];
  }
  return moved.move_by(all(increment));
}

HapticCycle CrtkSession::stand(CycleStatus why) noexcept {
  return std::visit(
      [&](auto& proxy) {
        // While the goal's message is valid and recent, the hand is known.
        const bool is_known = why == CycleStatus::lagging && command_ == Command::pose;
        return is_known ? proxy.stand(why, position_of(goal_)) : proxy.stand(why);
      },
      proxy_);
}

CycleStatus CrtkSession::finish(const HapticCycle& cycle) noexcept {
  cycle_ = cycle;
  Vec3 force = cycle.force;
  if (tip() != nullptr) {
    force = registration_.force_to_robot(force);
    if (cycle.ok()) setpoint_ = Pose{registration_.point_to_robot(cycle.proxy), goal_.rotation};
  } else if (cycle.ok()) {
    const InstrumentProxy& moved = *instrument();
    setpoint_ = in_unit(moved.flange(), 1.0 / registration_.scale());
    for (std::size_t k = 0; k < moved.positions().size(); ++k) {
      setpoint_joints_[k] = moved.positions()[k] / scale_of(k);
    }
  }
  wrench_.force = options_.motion_scale * (options_.hand_from_robot * force);
  return cycle.status;
}

std::span<const double> CrtkSession::setpoint_jp() const noexcept {
  if (!engaged() || instrument() == nullptr) return {};
  return all(setpoint_joints_);
}

OperatingState CrtkSession::operating_state() const noexcept {
  const OperatingState robot = robot_state_.value_or(
      options_.needs_feedback ? OperatingState::disabled : OperatingState::enabled);
  if (robot != OperatingState::enabled) return robot;
  return engaged() && is_ready() ? OperatingState::enabled : OperatingState::paused;
}

const EnergyReport& CrtkSession::energy() const noexcept {
  return tip() != nullptr ? tip()->energy() : instrument()->energy();
}

}  // namespace keepout
