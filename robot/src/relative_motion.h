// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "point_motion.h"

namespace keepout {

/// The motion of an instrument's points in the frame of a mesh. The mesh may have any pose, and may
/// move in the cycle. Its frame's origin then moves on a straight line, and the mesh turns about
/// that origin, both at constant speed. This equals two more joints between the mesh and the
/// instrument's base: a revolute one, then a prismatic one (docs/joint-space-step.md, Lemma 3).
/// Positions are in the frame of the mesh unless the name says otherwise.
class RelativeMotion {
 public:
  /// `motion`: that of the points in the world. Both arguments must outlive this object.
  RelativeMotion(const Instrument& instrument, PointMotion& motion);

  /// Begins a cycle, after `motion` has begun it, with the pose of the mesh and its displacement in
  /// all of the cycle. [length], [rad]
  void begin_cycle(const Pose& mesh, const Twist& displacement) noexcept;
  /// Updates the bounds of the points' motion. Call it after each PointMotion::set_trial.
  void update_bounds() noexcept;

  /// Returns the pose of the mesh at a knot.
  Pose pose_at(int knot) const noexcept;
  /// Returns a position of the world in the frame of the mesh at a knot. [length]
  Vec3 in_mesh(const Vec3& position, int knot) const noexcept;
  /// Returns a direction of the mesh's frame at the start of the cycle, in the world.
  Vec3 direction_in_world_at_start(const Vec3& direction) const noexcept {
    return is_world_frame_ ? direction : Vec3(pose_.rotation * direction);
  }
  /// Like direction_in_world_at_start(), but for a position. [length]
  Vec3 in_world_at_start(const Vec3& position) const noexcept {
    return is_world_frame_ ? position : pose_ * position;
  }

  /// Returns the positions of all points at a knot, by their number. [length]
  const Vec3* points_in_mesh(int knot) noexcept {
    if (is_world_frame_) return joint_motion_->points_at(knot);
    PointMotion::Positions& there = positions_[static_cast<std::size_t>(knot)];
    if (knot != 0 && there.motion_number != joint_motion_->number()) compute(knot, there);
    return there.points.data();
  }
  /// Copies the positions of one body's points at a knot into `core`, and returns them. [length]
  std::span<const Vec3> core_at(std::size_t body, int knot, CorePositions& core) noexcept;
  /// Returns the positions of all points at the start of the cycle. [length]
  const Vec3* start_in_mesh() noexcept { return points_in_mesh(0); }
  /// Returns a bound of a point's second derivative with respect to the fraction of the motion.
  /// [length]
  double bend(std::size_t point) const noexcept { return bounds_[point].bend; }
  /// Returns a bound of the displacement of all points of a body on the whole motion (rho of
  /// docs/joint-space-step.md, Lemma 5). [length]
  double largest_displacement(std::size_t body) noexcept;
  /// Returns true if the mesh moves in the cycle.
  bool is_moving() const noexcept { return turn_ > 0.0 || !displacement_.linear.isZero(0.0); }
  /// Returns a bound of the displacement of a body by the motion of the mesh alone. [length]
  double mesh_displacement_bound(std::size_t body) noexcept;

 private:
  /// Returns the bounds of a point's own motion plus that of the mesh. `at`: the point at the
  /// start.
  MotionBounds with_mesh(const MotionBounds& own, const Vec3& at) const noexcept;
  void compute(int knot, PointMotion::Positions& there) noexcept;

  const Instrument* instrument_;
  PointMotion* joint_motion_;
  Pose pose_ = {};              // of the mesh at the start of the cycle
  Twist displacement_ = {};     // of the mesh in the cycle
  double turn_ = 0.0;           // |displacement_.angular| [rad]
  Vec3 axis_ = Vec3::Zero();    // of the turn: unit
  bool is_world_frame_ = true;  // the mesh stands still, and its frame is that of the world
  std::array<MotionBounds, Instrument::most_points> bounds_{};
  std::vector<PointMotion::Positions> positions_;  // (last_knot + 1)
};

}  // namespace keepout
