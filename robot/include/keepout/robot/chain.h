// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/pose.h"

namespace keepout {

/// The way a joint moves the links beyond it.
enum class JointKind : std::uint8_t {
  revolute,  // turns them about the axis [rad]
  prismatic  // moves them along the axis [length]
};

/// The limits of a joint; infinite without a limit.
struct JointLimits {
  double lower = -std::numeric_limits<double>::infinity();     // least position
  double upper = std::numeric_limits<double>::infinity();      // largest position, >= lower
  double velocity = std::numeric_limits<double>::infinity();   // [rad/s] or [length/s], > 0
  double increment = std::numeric_limits<double>::infinity();  // in a cycle, > 0
};

/// One joint of a chain, and the fixed transform to it from the previous joint.
struct Joint {
  std::string name = {};                 // for messages
  JointKind kind = JointKind::revolute;  // how it moves the links beyond it
  /// The joint's frame, in the frame of the previous link. At position 0 it is the frame of the
  /// link that the joint moves.
  Pose origin = {};
  Vec3 axis = Vec3::UnitZ();  // unit, in the joint's frame
  JointLimits limits = {};    // the limits of its position and motion
};

class ChainState;

/// A serial chain of revolute and prismatic joints that carries an instrument. Link 0 is the base;
/// joint k moves link k, from 1 on. The last link has the flange.
///
/// Conventions are those of URDF: a link's frame is the joint's frame, moved by the joint. For
/// tables of Denavit and Hartenberg use `joints_of` (denavit_hartenberg.h).
class Chain {
 public:
  /// The most joints of a chain.
  static constexpr int most_joints = 8;

  /// Makes a chain. `base`: the pose of link 0 in the world. `flange`: the frame that is steered,
  /// in the frame of the last link. Throws Error, which names the joint, for an axis that is not a
  /// unit vector, an invalid pose, and limits that are empty or NaN. Also throws Error unless there
  /// are 1 to most_joints joints.
  explicit Chain(std::vector<Joint> joints, const Pose& base = {}, const Pose& flange = {});

  /// Returns the number of joints, n.
  int size() const noexcept { return static_cast<int>(joints_.size()); }
  /// Returns joint k, from 1 to size().
  const Joint& joint(int k) const noexcept { return joints_[static_cast<std::size_t>(k - 1)]; }
  /// Returns the pose of link 0 in the world.
  const Pose& base() const noexcept { return base_; }
  /// Returns the frame that is steered, in the frame of the last link.
  const Pose& flange() const noexcept { return flange_; }

  /// Returns an upper bound of the distance from the origin of the base to that of any link or the
  /// flange. It is the sum of all lengths between joints, plus the travel of prismatic joints.
  /// Infinite for a prismatic joint without limits. [length]
  double reach() const noexcept { return reach_; }

  /// Computes the forward kinematics: the poses of all links at positions q (n) [rad or length].
  /// Does not allocate. Precondition: q has size() finite numbers.
  void forward_kinematics(std::span<const double> q, ChainState& state) const noexcept;

 private:
  std::vector<Joint> joints_;
  Pose base_;
  Pose flange_;
  double reach_ = 0.0;

  // The fixed transforms between joints, rotated so that each axis is the z axis of its frame.
  struct Way {
    Mat3 rotation;
    Vec3 position;
  };
  std::array<Way, most_joints> ways_;
  std::array<Mat3, most_joints + 1> to_link_;  // from a link's frame to that rotated frame
  friend class ChainState;
};

/// The poses of the links of a chain at one configuration, in the world.
class ChainState {
 public:
  /// Makes an empty state: see Chain::forward_kinematics.
  ChainState() = default;

  /// Returns the number of joints, n.
  int size() const noexcept { return size_; }
  /// Returns the origin of link k, a point on the axis of joint k, from 1 to size(). [length]
  const Vec3& origin(int k) const noexcept { return position_[static_cast<std::size_t>(k)]; }
  /// Returns the axis of joint k, a unit vector.
  const Vec3& axis(int k) const noexcept { return axis_[static_cast<std::size_t>(k)]; }
  /// Returns true if joint k is revolute.
  bool turns(int k) const noexcept { return turns_[static_cast<std::size_t>(k)]; }

  /// Returns the position of a point of a link in the world. [length]
  Vec3 at(int link, const Vec3& point) const noexcept;
  /// Returns the pose of a link.
  Pose link(int link) const noexcept;
  /// Returns the pose of the flange.
  Pose flange() const noexcept;

  /// Returns column k of the Jacobian of a point `at` of link `link`: the motion of the point per
  /// unit of joint k. Zero for joints beyond the link. [length / unit of the joint]
  Vec3 linear(int k, int link, const Vec3& at) const noexcept {
    if (k > link) return Vec3::Zero();
    return turns(k) ? Vec3(axis(k).cross(at - origin(k))) : axis(k);
  }
  /// Returns the rotation of link `link` per unit of joint k. [rad / unit of the joint]
  Vec3 angular(int k, int link) const noexcept {
    return k <= link && turns(k) ? axis(k) : Vec3::Zero();
  }

 private:
  friend class Chain;
  const Chain* chain_ = nullptr;
  int size_ = 0;
  // The links 0 to n, in frames whose z is the joint's axis.
  std::array<Mat3, Chain::most_joints + 1> rotation_;
  std::array<Vec3, Chain::most_joints + 1> position_;
  std::array<Vec3, Chain::most_joints + 1> axis_;
  std::array<bool, Chain::most_joints + 1> turns_ = {};
};

}  // namespace keepout
