// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/fixtures/random.h"
#include "keepout/robot/instrument_constraint.h"
#include "verify/scene.h"

namespace keepout::app {

/// The fastest that is asked of a flange at speed 1.
inline constexpr double fastest_way = 0.5;    // in a cycle [mm]
inline constexpr double fastest_turn = 0.02;  // in a cycle [rad]

/// What is asked of a flange, cycle by cycle: to push, to slide, to turn, to tremble, and to go to
/// a place behind the surface, in turn.
class RobotHand {
 public:
  /// `speed`: multiples of fastest_way and fastest_turn. Both must outlive the hand.
  RobotHand(Scene& scene, Random& random, double speed);

  Twist next(const Vec3& flange);

 private:
  enum class Habit : std::uint8_t { push, slide, turn, tremble, go_behind };

  Scene* scene_;
  Random* random_;
  double speed_;
  std::size_t cycle_ = 0;
  Habit habit_ = Habit::push;
  double way_ = 0.0;    // in a cycle, at most [mm]
  double turn_ = 0.0;   // in a cycle, at most [rad]
  double guess_ = 0.0;  // how far the surface is [mm]
  Vec3 inwards_ = Vec3::UnitX();
  Vec3 heading_ = Vec3::UnitX();
  Vec3 axis_ = Vec3::UnitX();
  Vec3 goal_ = Vec3::Zero();
};

}  // namespace keepout::app
