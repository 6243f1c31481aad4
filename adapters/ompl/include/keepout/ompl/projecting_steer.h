// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// How a way is led along the anatomy.
struct SteerOptions {
  /// The longest step on a way that is held back. Short ones follow the surface closely, long ones
  /// are few. 0: an eighth of the motion sphere's radius. [length]
  double sliding_step = 0.0;
  /// A step that brings the tip nearer to the target by less than this fraction of its length ends
  /// the way: it slides along, but leads nowhere. In [0, 1).
  double least_gain = 0.05;
  std::size_t most_steps = 1000;  // of one way
};

/// A steering function for any planner: leads a tip from a place towards another by certified
/// steps, which slide along the anatomy where it is in the way. Each straight piece of the way is a
/// step that the rule has proven, so the whole way keeps the margin as docs/certified-step.md
/// promises; and each comes nearer to the target, so the way ends.
///
/// Not thread-safe, as the guard is not. The same ways whatever was asked before, as long as
/// the guard is asked for nothing else in between where it asks about sides.
class ProjectingSteer {
 public:
  /// The guard must outlive this. Throws Error for options out of range.
  explicit ProjectingSteer(MotionConstraint& guard, const SteerOptions& options = {});

  /// Why a way ends where it does.
  enum class Ending : std::uint8_t {
    arrived,    // the last way point is the target, to the last bit
    length,     // as long as asked for
    stuck,      // nothing leads nearer: a wall, or a hollow
    steps,      // the budget of steps is spent
    not_free,   // the tip may not be where the way starts: see keeps_margin
    unbounded,  // the way left the bounds, and was cut off before
  };

  /// What a call of steer came to.
  struct Way {
    Ending ending = Ending::not_free;  // why there is no more of it
    /// The start first. The straight pieces between neighbors are proven. Valid until the next
    /// call. [length]
    std::span<const Vec3> points;
    double length = 0.0;  // of all pieces [length]
  };

  /// A way towards a target. `longest` bounds its length; the last step is cut to it. [length]
  /// `bounds`: the way ends before the first step that leads out of this box. It is convex, so all
  /// of the way is in it. The target need not be.
  Way steer(const Vec3& from, const Vec3& towards, double longest = infinity,
            const Box& bounds = {Vec3::Constant(-infinity), Vec3::Constant(infinity)});

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  MotionConstraint* guard_;
  SteerOptions options_;
  std::vector<Vec3> points_;
};

}  // namespace keepout
