// SPDX-License-Identifier: BSD-3-Clause
#include "joint_input.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

constexpr double largest_number = 1e9;    // in a task or a velocity
constexpr double rotation_digits = 1e-6;  // of each element of R^T R
constexpr double fastest_turn = 1.0;      // of a mesh in a cycle [rad]

/// Returns true if no value exceeds `most` in size; false for NaN.
bool are_within(std::span<const double> values, double most) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [most](double x) { return std::abs(x) <= most; });
}

bool is_within(const Vec3& vector, double most) noexcept {
  return are_within({vector.data(), 3}, most);
}

}  // namespace

Status check_start(const CycleMemory& memory, const InstrumentOptions& options,
                   std::span<const double> q) noexcept {
  for (const MeshMemory& mesh : memory.meshes) {
    const bool is_too_fast =
        !(options.period * mesh.velocity.angular.norm() <= fastest_turn) ||
        !(options.period * mesh.velocity.linear.norm() <= memory.largest_length);
    if (mesh.has_refused_pose || is_too_fast) return Status::invalid_input;
    if (!mesh.neighborhood->is_current()) return Status::mesh_changed;
  }
  // Meshes move, so rounding may hide a margin that was valid when it was set.
  if (memory.is_lost_in_rounding(options)) return Status::margin_too_small;
  const JointVector at_rest{};
  const auto n = static_cast<std::size_t>(memory.instrument.chain().size());
  return are_valid_positions(memory, q, {at_rest.data(), n}) ? Status::free : Status::invalid_input;
}

bool are_valid_positions(const CycleMemory& memory, std::span<const double> q,
                         std::span<const double> increment) noexcept {
  const auto n = static_cast<std::size_t>(memory.instrument.chain().size());
  if (q.size() != n || increment.size() != n) return false;
  for (std::size_t k = 0; k < n; ++k) {
    const double there = q[k] + increment[k];
    const double most = IncrementBox::largest_position(
        memory.instrument.chain(), static_cast<int>(k) + 1, memory.largest_length);
    if (!(std::abs(there) <= most)) return false;  // or NaN
  }
  return true;
}

bool is_valid_task(const Twist& displacement) noexcept {
  return is_within(displacement.linear, largest_number) &&
         is_within(displacement.angular, largest_number);
}

bool is_valid_task(std::span<const double> desired, std::span<const double> weights,
                   std::size_t joints) noexcept {
  const bool is_weighed =
      weights.empty() || (weights.size() == joints && are_within(weights, largest_number) &&
                          *std::min_element(weights.begin(), weights.end()) > 0);
  return desired.size() == joints && are_within(desired, largest_number) && is_weighed;
}

bool is_valid_placement(const Pose& pose, const Twist& velocity, double largest_length) noexcept {
  const Mat3 off = pose.rotation.transpose() * pose.rotation - Mat3::Identity();
  return is_within(pose.position, largest_length) && are_within({off.data(), 9}, rotation_digits) &&
         pose.rotation.determinant() > 0.0 && is_within(velocity.linear, largest_number) &&
         is_within(velocity.angular, largest_number);
}

}  // namespace keepout
