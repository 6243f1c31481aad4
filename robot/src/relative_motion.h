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

/// The points of an instrument on their way as a mesh sees them, which may be elsewhere than it was
/// made, and may move in the cycle: its frame's origin on a straight line, and it turns about that,
/// both steadily. So it is as if two more joints were between the mesh and the instrument's base:
/// one that turns, and beyond it one that slides (docs/joint-space-step.md). All places are in the
/// frame of the mesh.
class RelativeMotion {
 public:
  /// Of the points of that motion, which must stay where it is.
  RelativeMotion(const Instrument& instrument, PointMotion& motion);

  /// A new cycle, after the points' own: where the mesh is, and how it moves in all of the cycle.
  /// [length], [rad]
  void start(const Pose& mesh, const Twist& way) noexcept;
  /// After the points were given another motion.
  void move() noexcept;

  /// The points' own motion, in the world.
  PointMotion& joints() const noexcept { return *motion_; }
  /// Where the mesh is at a share of the motion.
  Pose mesh_at(int cell) const noexcept;
  /// A place of the world, as the mesh sees it at a share of the motion. [length]
  Vec3 seen(const Vec3& place, int cell) const noexcept;
  /// A direction, as the mesh sees it when the cycle begins, in the world; and a place.
  Vec3 direction_in_world(const Vec3& direction) const noexcept {
    return is_at_home_ ? direction : Vec3(mesh_.rotation * direction);
  }
  /// The same of a place. [length]
  Vec3 place_in_world(const Vec3& place) const noexcept {
    return is_at_home_ ? place : mesh_ * place;
  }

  /// Where all points are at a share of the motion, by their number. [length]
  const Vec3* at(int cell) noexcept;
  /// The same of the points of one body, put into `core`. [length]
  std::span<const Vec3> core(std::size_t body, int cell, Core& core) noexcept;
  /// Where they are as the cycle begins. [length]
  const Vec3* at_start() noexcept { return at(0); }
  /// Bounds of a point's second derivative by the share. [length]
  double bend(std::size_t point) const noexcept { return bounds_[point].bend; }
  /// How far any point of a body is from its start at the most, on the way. [length]
  double farthest(std::size_t body) noexcept;
  /// Whether the mesh moves in the cycle.
  bool is_moving() const noexcept { return turn_ > 0.0 || !way_.linear.isZero(0.0); }
  /// How far the mesh alone moves a body at the most. [length]
  double drift(std::size_t body) noexcept;

 private:
  struct Place {
    std::array<Vec3, Instrument::most_points> points;
    std::uint64_t motion = 0;  // of which motion; 0: none
  };

  /// A point's bounds, once the mesh's motion has come to its own.
  MotionBounds with_mesh(const MotionBounds& own, const Vec3& at) const noexcept;

  const Instrument* instrument_;
  PointMotion* motion_;
  Pose mesh_ = {};
  Twist way_ = {};
  double turn_ = 0.0;         // |way_.angular| [rad]
  Vec3 axis_ = Vec3::Zero();  // of it, a unit vector
  bool is_at_home_ = true;  // the mesh is where it was made, and still: the world's places are its
  std::array<MotionBounds, Instrument::most_points> bounds_{};
  std::vector<Place> places_;  // (cells + 1)
};

}  // namespace keepout
