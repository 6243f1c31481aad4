// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/chain.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/rounding_mode.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

// Unit vectors and rotations are accepted if they are exact to six digits.
constexpr double digits = 1e-6;

bool is_rotation(const Mat3& r) noexcept {
  return r.allFinite() && (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff() <= digits &&
         r.determinant() > 0.0;
}

/// Returns target - a . b, as if computed with twice the digits (Ogita, Rump and Oishi 2005).
/// Precondition: a . b is near the target.
double missing_of(double target, const Vec3& a, const Vec3& b) {
  double sum = target;
  double error = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double product = -a[i] * b[i];
    const double next = sum + product;
    const double added = next - sum;
    error += (sum - (next - added)) + (product - added) + std::fma(-a[i], b[i], -product);
    sum = next;
  }
  return sum + error;
}

/// Returns the rotation nearest to a matrix that is a rotation to six digits. The result is rounded
/// only once, because errors of rotations add up along a chain. Newton's method for the polar
/// factor (Higham 1986) doubles the digits in each step.
Mat3 nearest_rotation(Mat3 r) {
  for (int step = 0; step < 3; ++step) {
    Mat3 missing;  // identity - r^T r
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        missing(i, j) = missing_of(i == j ? 1.0 : 0.0, r.col(i), r.col(j));
    }
    r += (0.5 * r * missing).eval();
  }
  return r;
}

/// Returns the shortest rotation from z to an axis. If -z is nearer to the axis, returns half a
/// turn about x, followed by the shortest rotation from -z.
Mat3 to_axis(const Vec3& axis) {
  const double side = std::copysign(1.0, axis.z());
  const double x = axis.x();
  const double y = axis.y();
  const double fraction = 1.0 / (1.0 + std::abs(axis.z()));
  Mat3 r;
  r << 1.0 - fraction * x * x, -side * fraction * x * y, x,   //
      -fraction * x * y, side * (1.0 - fraction * y * y), y,  //
      -side * x, -y, axis.z();
  return nearest_rotation(r);
}

void require_pose(const Pose& pose, const std::string& whose) {
  if (pose.position.allFinite() && pose.position.norm() <= longest_length &&
      is_rotation(pose.rotation)) {
    return;
  }
  throw Error(
      whose +
      " is not a pose: its position must be finite, and its matrix a rotation to six digits");
}

void require_usable(const Joint& joint, const std::string& which) {
  require_pose(joint.origin, "the origin of " + which);
  if (!(std::abs(joint.axis.norm() - 1.0) <= digits)) {
    throw Error("the axis of " + which + " is not a unit vector");
  }
  const JointLimits& limits = joint.limits;
  if (!(limits.lower <= limits.upper) || !(limits.lower < longest_length) ||
      !(limits.upper > -longest_length)) {
    throw Error(which + " has a lower limit above its upper one, or one that is not a number: " +
                text_of(limits.lower) + " and " + text_of(limits.upper));
  }
  for (const auto& [name, limit] :
       {std::pair("velocity", limits.velocity), std::pair("increment", limits.increment)}) {
    if (limit > 0.0) continue;
    throw Error(which + " has a limit of " + name + " that is not above zero: " + text_of(limit));
  }
}

}  // namespace

Chain::Chain(std::vector<Joint> joints, const Pose& base, const Pose& flange)
    : joints_(std::move(joints)), base_(base), flange_(flange) {
  require_rounding_to_nearest();
  if (joints_.empty() || joints_.size() > static_cast<std::size_t>(most_joints)) {
    throw Error("a chain has 1 to " + std::to_string(most_joints) + " joints, not " +
                std::to_string(joints_.size()));
  }
  require_pose(base_, "the base of the chain");
  require_pose(flange_, "the flange of the chain");
  base_.rotation = nearest_rotation(base_.rotation);
  flange_.rotation = nearest_rotation(flange_.rotation);
  Mat3 turned = Mat3::Identity();  // from the turned frame of the link before to its own
  to_link_[0] = turned;
  reach_ = flange_.position.norm();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    std::string which = "joint " + std::to_string(i + 1);
    if (!joint.name.empty()) which += " ('" + joint.name + "')";
    require_usable(joint, which);
    joint.axis.normalize();
    joint.origin.rotation = nearest_rotation(joint.origin.rotation);
    const Mat3 here = to_axis(joint.axis);
    ways_[i] = {nearest_rotation(turned.transpose() * joint.origin.rotation * here),
                turned.transpose() * joint.origin.position};
    turned = here;
    to_link_[i + 1] = here.transpose();
    reach_ += joint.origin.position.norm();
    if (joint.kind == JointKind::prismatic) {
      reach_ += std::max(std::abs(joint.limits.lower), std::abs(joint.limits.upper));
    }
  }
}

void Chain::forward_kinematics(std::span<const double> q, ChainState& state) const noexcept {
  state.chain_ = this;
  state.size_ = size();
  state.rotation_[0] = base_.rotation;
  state.position_[0] = base_.position;
  state.axis_[0] = base_.rotation.col(2);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Way& way = ways_[i];
    const Mat3& before = state.rotation_[i];
    Mat3& rotation = state.rotation_[i + 1];
    Vec3& position = state.position_[i + 1];
    rotation.noalias() = before * way.rotation;
    position.noalias() = state.position_[i] + before * way.position;
    state.axis_[i + 1] = rotation.col(2);
    const bool turns = joints_[i].kind == JointKind::revolute;
    state.turns_[i + 1] = turns;
    if (turns) {
      const double sine = std::sin(q[i]);
      const double cosine = std::cos(q[i]);
      const Vec3 x = rotation.col(0);
      const Vec3 y = rotation.col(1);
      rotation.col(0) = cosine * x + sine * y;
      rotation.col(1) = cosine * y - sine * x;
    } else {
      position += q[i] * state.axis_[i + 1];
    }
  }
}

Vec3 ChainState::at(int link, const Vec3& point) const noexcept {
  const auto l = static_cast<std::size_t>(link);
  return position_[l] + rotation_[l] * (chain_->to_link_[l] * point);
}

Pose ChainState::link(int link) const noexcept {
  const auto l = static_cast<std::size_t>(link);
  return {position_[l], rotation_[l] * chain_->to_link_[l]};
}

Pose ChainState::flange() const noexcept { return link(size_) * chain_->flange_; }

}  // namespace keepout
