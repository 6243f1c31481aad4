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

/// How a joint moves what is beyond it.
enum class JointKind : std::uint8_t {
  revolute,  // turns it about the axis [rad]
  prismatic  // moves it along the axis [length]
};

/// What a joint may do. Infinite where there is no limit.
struct JointLimits {
  double lower = -std::numeric_limits<double>::infinity();     // least position
  double upper = std::numeric_limits<double>::infinity();      // largest position, >= lower
  double velocity = std::numeric_limits<double>::infinity();   // [rad/s] or [length/s], > 0
  double increment = std::numeric_limits<double>::infinity();  // in a cycle, > 0
};

/// One joint of a chain, and the fixed way to it from the one before.
struct Joint {
  std::string name = {};                 // for messages
  JointKind kind = JointKind::revolute;  // how it moves what is beyond it
  /// The joint's frame, told in that of the link before it. At position 0 it is the frame of the
  /// link that the joint moves.
  Pose origin = {};
  Vec3 axis = Vec3::UnitZ();  // unit, in the joint's frame
  JointLimits limits = {};    // what it may do
};

class ChainState;

/// A serial chain of revolute and prismatic joints: what carries an instrument. Link 0 is the base,
/// link k the one that joint k moves, counted from 1; the last bears the flange.
///
/// Conventions are those of URDF: a link's frame is the joint's frame, moved by the joint. Tables
/// after Denavit and Hartenberg become joints by `joints_of` (denavit_hartenberg.h).
class Chain {
 public:
  /// Of a chain.
  static constexpr int most_joints = 8;

  /// `base`: the pose of link 0 in the world. `flange`: the frame that is steered, told
  /// in that of the last link. Throws Error, naming the joint, for none or more than most_joints,
  /// an axis that is not a unit vector, a pose that is none, or limits that are empty or no
  /// numbers.
  explicit Chain(std::vector<Joint> joints, const Pose& base = {}, const Pose& flange = {});

  /// How many joints there are, n.
  int size() const noexcept { return static_cast<int>(joints_.size()); }
  /// Joint k, from 1 to size().
  const Joint& joint(int k) const noexcept { return joints_[static_cast<std::size_t>(k - 1)]; }
  /// Returns the pose of link 0 in the world.
  const Pose& base() const noexcept { return base_; }
  /// The frame that is steered, in that of the last link.
  const Pose& flange() const noexcept { return flange_; }

  /// The lengths of the fixed ways from joint to joint, and of what prismatic joints with limits
  /// can add: no point of the base is farther from one of the last link. Infinite for a prismatic
  /// joint without limits. [length]
  double reach() const noexcept { return reach_; }

  /// Forward kinematics: where all is at positions q (n) [rad or length]. Allocates nothing.
  /// Precondition: q has size() finite numbers.
  void forward_kinematics(std::span<const double> q, ChainState& state) const noexcept;

 private:
  std::vector<Joint> joints_;
  Pose base_;
  Pose flange_;
  double reach_ = 0.0;

  // The fixed ways once more, turned so that each axis is its frame's z.
  struct Way {
    Mat3 rotation;
    Vec3 position;
  };
  std::array<Way, most_joints> ways_;
  std::array<Mat3, most_joints + 1> to_link_;  // from a link's frame to the one turned so
  friend class ChainState;
};

/// The poses of the links of a chain at one configuration, in the world.
class ChainState {
 public:
  /// Of no chain yet: see Chain::forward_kinematics.
  ChainState() = default;

  /// How many joints there are, n.
  int size() const noexcept { return size_; }
  /// A point on the axis of joint k, from 1 to size(): the origin of link k. [length]
  const Vec3& origin(int k) const noexcept { return position_[static_cast<std::size_t>(k)]; }
  /// The axis of joint k, a unit vector.
  const Vec3& axis(int k) const noexcept { return axis_[static_cast<std::size_t>(k)]; }
  /// Whether joint k turns.
  bool turns(int k) const noexcept { return turns_[static_cast<std::size_t>(k)]; }

  /// Returns the position of a point of a link in the world. [length]
  Vec3 at(int link, const Vec3& point) const noexcept;
  /// Where the frame of a link is.
  Pose link(int link) const noexcept;
  /// Where the flange is.
  Pose flange() const noexcept;

  /// Column k of the Jacobian of a point that link `link` carries: how it moves with joint k. Zero
  /// for joints beyond. [length / unit of the joint]
  Vec3 linear(int k, int link, const Vec3& at) const noexcept {
    if (k > link) return Vec3::Zero();
    return turns(k) ? Vec3(axis(k).cross(at - origin(k))) : axis(k);
  }
  /// How link `link` turns with joint k. [rad / unit of the joint]
  Vec3 angular(int k, int link) const noexcept {
    return k <= link && turns(k) ? axis(k) : Vec3::Zero();
  }

 private:
  friend class Chain;
  const Chain* chain_ = nullptr;
  int size_ = 0;
  // Of link 0 to n, in frames whose z is the joint's axis.
  std::array<Mat3, Chain::most_joints + 1> rotation_;
  std::array<Vec3, Chain::most_joints + 1> position_;
  std::array<Vec3, Chain::most_joints + 1> axis_;
  std::array<bool, Chain::most_joints + 1> turns_ = {};
};

}  // namespace keepout
