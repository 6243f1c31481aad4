// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "keepout/control/haptic_force.h"
#include "keepout/step/guide.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// How a cycle of a controller ended. Of the first the proxy has moved as the engine's step says;
/// after any other it stands where it was.
enum class CycleStatus : std::uint8_t {
  guarded,        // the step was ok: see it for whether and how it was limited
  not_engaged,    // engage() has not placed the proxy yet: there is no force either
  invalid_pose,   // a number is not finite, or the rotation is none
  too_far,        // the goal is farther from the proxy than a hand can be: wrong unit, or a jump
  stale,          // there was no goal for too long
  lagging,        // the robot is not where it was sent
  far_from_mesh,  // on engaging: so far from the mesh that unit or registration must be wrong
  stopped         // the engine refused the step: see its status
};

/// Whether the proxy went where the step allowed.
constexpr bool is_ok(CycleStatus status) noexcept { return status == CycleStatus::guarded; }

/// The name as it stands in the enumeration, for logs.
std::string_view name(CycleStatus status) noexcept;

/// One line on what happened and what to do about it.
std::string_view reason(CycleStatus status) noexcept;

/// How a proxy is led, and how it pulls the hand.
struct HapticOptions {
  double period = 0.001;     // of a cycle [s], 1e-6 to 1
  SpringDamper spring = {};  // between proxy and hand
  double top_speed = 200.0;  // of the proxy, which the robot follows [length / s], > 0
  double farthest = 50.0;    // of the hand from the proxy; beyond it is refused [length], > 0
  /// How long the force takes to die when cycles fail, and to come back [s], >= period
  double fade = 0.05;
  double largest_brake = 0.0;  // of the passivity controller [N s / length]; 0: it only observes
  std::vector<Guide> guides = {};  // of the proxy, in the frame of the mesh: Guide::point
};

/// What a cycle came to.
struct HapticCycle {
  CycleStatus status = CycleStatus::not_engaged;  // how it ended
  Status step = Status::invalid_input;  // the engine's; of guarded and stopped cycles only
  Limits limits = {};                   // what limited the step
  Vec3 proxy = Vec3::Zero();            // where the tool shall be [length]
  Vec3 force = Vec3::Zero();            // on the hand, from now on until the next cycle [N]

  /// Whether the proxy went where the step allowed.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; of a stopped cycle, the engine's.
  std::string_view reason() const noexcept {
    return status == CycleStatus::stopped ? keepout::reason(step, Subject::tip)
                                          : keepout::reason(status);
  }
};

/// A proxy of the hand that stays out of the mesh (the god-object of Zilles and Salisbury 1995,
/// whose constraint is the certified step), and the force that pulls the hand to it. All in the
/// frame and the unit of the mesh. Not thread-safe; a cycle allocates, locks and throws nothing.
///
/// When a cycle fails, the proxy stands still. The force must not jump, for the hand leans against
/// it; nor may a fault leave a motor pushing. So it goes on to be that of the spring to the
/// standing proxy, which is where the tool is, and fades out over `fade` seconds; while there is no
/// hand to measure, the last force fades. With the first good cycle it comes back over as many
/// seconds.
class HapticProxy {
 public:
  /// Throws Error for an option out of range, and for guides as MotionConstraint::set_guides does.
  /// The step of a cycle, top_speed * period, is cut to
  /// the radius of the motion sphere; and the guard's recovery to that step.
  HapticProxy(MotionConstraint guard, const HapticOptions& options);

  /// Places proxy and hand at a tip: at the start, and whenever the hand has moved on its own
  /// (after clutching). No force; energies start anew. guarded, or invalid_pose.
  CycleStatus engage(const Vec3& tip) noexcept;

  /// Lets go: no force at once, no cycle until it is engaged anew. The energies stay to be read.
  void release() noexcept;

  /// One cycle: the proxy goes towards the hand as far as the mesh allows.
  HapticCycle cycle(const Vec3& hand) noexcept;

  /// A cycle in which the proxy must not move, and why; the hand is where it was last seen, unless
  /// it is given. The force fades.
  HapticCycle stand(CycleStatus why) noexcept;
  /// The same, with the hand in sight. [length]
  HapticCycle stand(CycleStatus why, const Vec3& hand) noexcept;

  /// Where the tool shall be. [length]
  const Vec3& proxy() const noexcept { return proxy_; }
  /// Whether it has been placed, and not been let go since.
  bool engaged() const noexcept { return engaged_; }
  /// Returns the state of each of the options' guides in the last step; empty before it.
  std::span<const GuideState> guides() const noexcept { return guide_states_; }
  /// Returns the work of the last step: see Budget.
  std::size_t work_units() const noexcept { return guard_.work_units(); }
  /// Returns work_units().
  [[deprecated("use work_units()")]] std::size_t looks() const noexcept { return work_units(); }
  /// What went to and fro since it was engaged.
  const EnergyReport& energy() const noexcept { return energy_; }
  /// As they were given.
  const HapticOptions& options() const noexcept { return options_; }
  /// What the proxy is kept out of.
  const Mesh& mesh() const noexcept { return guard_.mesh(); }

 private:
  /// Books the cycle past, and takes down where the hand is.
  void book(const Vec3& hand, const Vec3& proxy_way) noexcept;
  void update_force() noexcept;
  void fade(double towards) noexcept;
  HapticCycle finish(CycleStatus status, Status step) const noexcept;

  MotionConstraint guard_;
  HapticOptions options_;
  double longest_;  // way of the proxy in a cycle [length]
  PassivityObserver passivity_;
  EnergyReport energy_;
  HeldForce held_;  // since the last cycle
  Vec3 proxy_ = Vec3::Zero();
  Vec3 hand_ = Vec3::Zero();                  // where it was last seen
  Vec3 hand_way_ = Vec3::Zero();              // in the cycle past; zero when it was not seen twice
  double stretch_ = 0.0;                      // between proxy and hand in the last cycle [length]
  double rate_ = 0.0;                         // of the stretch [length / s]
  double share_ = 1.0;                        // of the force that has not faded
  std::span<const GuideState> guide_states_;  // views of the guard's
  bool engaged_ = false;
  bool seen_ = false;  // whether the last cycle saw the hand
};

}  // namespace keepout
