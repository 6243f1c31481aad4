// SPDX-License-Identifier: BSD-3-Clause
#include "relative_motion.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace keepout {

RelativeMotion::RelativeMotion(const Instrument& instrument, PointMotion& motion)
    : instrument_(&instrument), motion_(&motion), places_(PointMotion::cells + 1) {}

void RelativeMotion::start(const Pose& mesh, const Twist& way) noexcept {
  mesh_ = mesh;
  way_ = way;
  turn_ = way.angular.norm();
  axis_ = turn_ > 0.0 ? Vec3(way.angular / turn_) : Vec3::Zero();
  is_at_home_ = mesh.position.isZero(0.0) && mesh.rotation == Mat3::Identity() &&
                way.linear.isZero(0.0) && turn_ == 0.0;
  if (is_at_home_) return;
  const std::size_t count = instrument_->points().size();
  for (std::size_t p = 0; p < count; ++p) {
    places_[0].points[p] = seen(motion_->at_start()[p], 0);
  }
}

void RelativeMotion::move() noexcept {
  for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
    bounds_[p] =
        is_at_home_ ? motion_->bounds(p) : with_mesh(motion_->bounds(p), motion_->at_start()[p]);
  }
}

/// As motion_bounds, with two joints more: a prismatic one, and farther in a revolute one.
MotionBounds RelativeMotion::with_mesh(const MotionBounds& own, const Vec3& at) const noexcept {
  MotionBounds bounds = own;
  bounds.path += way_.linear.norm();
  const double lever = axis_.cross(at - mesh_.position).norm() + bounds.path;
  bounds.bend += turn_ * (lever * turn_ + 2.0 * bounds.path);
  bounds.path += lever * turn_;
  return bounds;
}

Pose RelativeMotion::mesh_at(int cell) const noexcept {
  const double share = static_cast<double>(cell) / PointMotion::cells;
  Pose pose = mesh_;
  pose.position += share * way_.linear;
  if (turn_ > 0.0 && cell > 0) {
    pose.rotation = Eigen::AngleAxisd(share * turn_, axis_).toRotationMatrix() * mesh_.rotation;
  }
  return pose;
}

Vec3 RelativeMotion::seen(const Vec3& place, int cell) const noexcept {
  if (is_at_home_) return place;
  const Pose mesh = mesh_at(cell);
  return mesh.rotation.transpose() * (place - mesh.position);
}

const Vec3* RelativeMotion::at(int cell) noexcept {
  if (is_at_home_) return motion_->at(cell);
  Place& there = places_[static_cast<std::size_t>(cell)];
  if (cell == 0 || there.motion == motion_->number()) return there.points.data();
  there.motion = motion_->number();
  const Vec3* in_world = motion_->at(cell);
  const Pose mesh = mesh_at(cell);
  for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
    there.points[p] = mesh.rotation.transpose() * (in_world[p] - mesh.position);
  }
  return there.points.data();
}

std::span<const Vec3> RelativeMotion::core(std::size_t body, int cell, Core& core) noexcept {
  const Vec3* places = at(cell);
  const std::span<const std::uint8_t> points = instrument_->points_of(body);
  for (std::size_t i = 0; i < points.size(); ++i) core[i] = places[points[i]];
  return {core.data(), points.size()};
}

double RelativeMotion::farthest(std::size_t body) noexcept {
  const Vec3* end = at(PointMotion::cells);
  double most = 0.0;
  for (const std::uint8_t p : instrument_->points_of(body)) {
    const double chord = (end[p] - at_start()[p]).norm();
    most = std::max(most, std::min(bounds_[p].path, chord + bounds_[p].bend / 8.0));
  }
  return most;
}

double RelativeMotion::drift(std::size_t body) noexcept {
  if (!is_moving()) return 0.0;
  double most = 0.0;
  for (const std::uint8_t p : instrument_->points_of(body)) {
    most = std::max(most, with_mesh({}, motion_->at_start()[p]).path);
  }
  return most;
}

}  // namespace keepout
