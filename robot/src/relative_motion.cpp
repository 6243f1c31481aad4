// SPDX-License-Identifier: BSD-3-Clause
#include "relative_motion.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace keepout {

RelativeMotion::RelativeMotion(const Instrument& instrument, PointMotion& motion)
    : instrument_(&instrument), joint_motion_(&motion), positions_(PointMotion::last_knot + 1) {}

void RelativeMotion::begin_cycle(const Pose& mesh, const Twist& displacement) noexcept {
  pose_ = mesh;
  displacement_ = displacement;
  turn_ = displacement.angular.norm();
  axis_ = turn_ > 0.0 ? Vec3(displacement.angular / turn_) : Vec3::Zero();
  is_world_frame_ = mesh.position.isZero(0.0) && mesh.rotation == Mat3::Identity() &&
                    displacement.linear.isZero(0.0) && turn_ == 0.0;
  if (is_world_frame_) return;
  const std::size_t count = instrument_->points().size();
  for (std::size_t p = 0; p < count; ++p) {
    positions_[0].points[p] = in_mesh(joint_motion_->points_at_start()[p], 0);
  }
}

void RelativeMotion::update_bounds() noexcept {
  for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
    bounds_[p] = is_world_frame_
                     ? joint_motion_->bounds(p)
                     : with_mesh(joint_motion_->bounds(p), joint_motion_->points_at_start()[p]);
  }
}

MotionBounds RelativeMotion::with_mesh(const MotionBounds& own, const Vec3& at) const noexcept {
  MotionBounds bounds = own;
  bounds.slide(displacement_.linear.norm());
  bounds.turn(axis_.cross(at - pose_.position).norm(), turn_);
  return bounds;
}

Pose RelativeMotion::pose_at(int knot) const noexcept {
  const double fraction = static_cast<double>(knot) / PointMotion::last_knot;
  Pose pose = pose_;
  pose.position += fraction * displacement_.linear;
  if (turn_ > 0.0 && knot > 0) {
    pose.rotation = Eigen::AngleAxisd(fraction * turn_, axis_).toRotationMatrix() * pose_.rotation;
  }
  return pose;
}

Vec3 RelativeMotion::in_mesh(const Vec3& position, int knot) const noexcept {
  if (is_world_frame_) return position;
  const Pose mesh = pose_at(knot);
  return mesh.rotation.transpose() * (position - mesh.position);
}

void RelativeMotion::compute(int knot, PointMotion::Positions& there) noexcept {
  there.motion_number = joint_motion_->number();
  const Vec3* in_world = joint_motion_->points_at(knot);
  const Pose mesh = pose_at(knot);
  for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
    there.points[p] = mesh.rotation.transpose() * (in_world[p] - mesh.position);
  }
}

std::span<const Vec3> RelativeMotion::core_at(std::size_t body, int knot,
                                              CorePositions& core) noexcept {
  const Vec3* positions = points_in_mesh(knot);
  const std::span<const std::uint8_t> points = instrument_->points_of(body);
  for (std::size_t i = 0; i < points.size(); ++i) core[i] = positions[points[i]];
  return {core.data(), points.size()};
}

double RelativeMotion::largest_displacement(std::size_t body) noexcept {
  const Vec3* end = points_in_mesh(PointMotion::last_knot);
  double most = 0.0;
  for (const std::uint8_t p : instrument_->points_of(body)) {
    const double chord = (end[p] - start_in_mesh()[p]).norm();
    most = std::max(most, std::min(bounds_[p].path, chord + bounds_[p].bend / 8.0));
  }
  return most;
}

double RelativeMotion::mesh_displacement_bound(std::size_t body) noexcept {
  if (!is_moving()) return 0.0;
  double most = 0.0;
  for (const std::uint8_t p : instrument_->points_of(body)) {
    most = std::max(most, with_mesh({}, joint_motion_->points_at_start()[p]).path);
  }
  return most;
}

}  // namespace keepout
