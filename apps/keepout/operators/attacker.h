// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/twist.h"
#include "verify/scene.h"

namespace keepout::app {

/// The motion that an attacker commands.
enum class Route : std::uint8_t {
  // Routes of a tip, which does not change its route:
  push,       // straight into the surface
  slide,      // into the surface and along it
  walk,       // in random directions, in steps of all lengths
  aim,        // to the corners and edges of the nearest triangle
  ping_pong,  // from wall to wall
  tremor,     // to a place behind the surface, trembling
  come_back,  // away from the surface, and back into it
  through,    // to distant places, through the surface
  // Routes of a flange, which changes its route:
  press,     // to the place of the surface that is nearest now
  drag,      // like press, and along the surface
  turn,      // about an axis, and a little to the surface
  tremble,   // to a place behind the surface, trembling
  go_behind  // to a place behind the surface, turning a little
};

/// The fastest motions of a flange at speed 1.
inline constexpr double fastest_way = 0.5;    // in a cycle [mm]
inline constexpr double fastest_turn = 0.02;  // in a cycle [rad]

/// An operator who tries to break the guard of a tool: finds the surface every few cycles, and
/// commands motions into it. Scene and random numbers must outlive the attacker.
class Attacker {
 public:
  /// Attacks with a tip, on one of its routes, by at most `longest` a cycle. `kept`: the required
  /// clearance. [length]
  Attacker(Scene& scene, Random& random, Route route, double longest, double kept);

  /// Attacks with a flange, on a route drawn every 250 cycles. `speed`: multiples of fastest_way
  /// and fastest_turn.
  Attacker(Scene& scene, Random& random, double speed);

  /// Returns the motion to command in this cycle. `at`: the position of the tip or flange. The
  /// motion of a tip has no rotation.
  Twist next(const Vec3& at);

 private:
  void look(const Vec3& at);
  Vec3 target_on_triangle() const;
  Twist wish(const Vec3& at, bool is_turn);

  Scene* scene_;
  Random* random_;
  Route route_ = Route::press;
  double longest_ = 0.0;   // motion in a cycle [length]
  double turn_ = 0.0;      // of a flange in a cycle [rad]
  double kept_ = 0.0;      // required clearance of a tip [length]
  double speed_ = 0.0;     // of a flange
  std::size_t period_;     // after which it turns back, or draws another goal or route [cycles]
  std::size_t attention_;  // interval at which it finds the surface [cycles]
  bool has_all_lengths_ = false;  // motions of all lengths, not only of the longest
  std::size_t cycle_ = 0;
  double guess_ = 0.0;       // bound for the search of the surface [length]
  TriangleId triangle_ = 0;  // nearest to the tool
  Vec3 inwards_ = Vec3::UnitX(), heading_ = Vec3::UnitY(), axis_ = Vec3::UnitX();  // unit vectors
  Vec3 goal_ = Vec3::Zero();
};

}  // namespace keepout::app
