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

/// The options of ProjectingSteer.
struct SteerOptions {
  /// The longest step while sliding along the anatomy. Short steps follow the surface closely. A
  /// path of long steps has fewer steps. 0: an eighth of the motion sphere's radius. [length]
  double sliding_step = 0.0;
  /// The path ends at a step that reduces the distance to the target by less than this fraction of
  /// the step's length. In [0, 1).
  double least_gain = 0.05;
  std::size_t most_steps = 1000;  // of one path
};

/// A steering function for any planner. It moves a tip from one point towards another by certified
/// steps, which slide along the anatomy. Each straight piece of the path is a step that the rule
/// has proved, so the whole path maintains the required clearance (docs/certified-step.md). Each
/// step reduces the distance to the target, so the path ends.
///
/// Not thread-safe, like the motion constraint `guard`. Paths do not depend on earlier calls. If
/// the guard classifies tips as inside or outside, no other code may use the guard between two
/// calls.
class ProjectingSteer {
 public:
  /// Makes a steering function; the guard must outlive it. Throws Error for options out of range.
  explicit ProjectingSteer(MotionConstraint& guard, const SteerOptions& options = {});

  /// The cause of the end of a path.
  enum class Ending : std::uint8_t {
    arrived,    // the last point is exactly the target
    length,     // the path has the longest length
    stuck,      // no step leads nearer, as in front of a wall or in a hollow
    steps,      // the path has the most steps
    not_free,   // the start is not free or is out of bounds, or the target is not finite
    unbounded,  // the next step would leave the bounds
  };

  /// The path of a call of steer.
  struct Way {
    Ending ending = Ending::not_free;  // the cause of its end
    /// The points from the start on. The straight pieces between them are proved. Valid until the
    /// next call. [length]
    std::span<const Vec3> points;
    double length = 0.0;  // of all pieces [length]
  };

  /// Returns a path towards a target. `longest`: the largest length of the path, which shortens the
  /// last step [length]. `bounds`: the path ends before the first step that leaves this box. The
  /// box is convex, so it contains the whole path. The target may be outside.
  Way steer(const Vec3& from, const Vec3& towards, double longest = infinity,
            const Box& bounds = {Vec3::Constant(-infinity), Vec3::Constant(infinity)});

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  MotionConstraint* guard_;
  SteerOptions options_;
  std::vector<Vec3> points_;
};

}  // namespace keepout
