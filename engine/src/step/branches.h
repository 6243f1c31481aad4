// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A node of the branch and bound: planes, and the nearest motion that they allow.
struct Branch {
  /// Choices of more planes are dropped.
  static constexpr std::size_t most_planes = 24;

  double cost;  // distance from the target [length]
  Vec3 motion;  // [length]
  std::array<HalfSpace, most_planes> plane;
  std::size_t count;  // of planes
  bool is_open;

  std::span<const HalfSpace> planes() const noexcept { return {plane.data(), count}; }
};

/// The nodes of a search, in memory that is allocated once. Nodes that do not fit are dropped,
/// which costs quality and not safety.
class Branches {
 public:
  /// Allocates memory for `capacity` nodes of a search.
  explicit Branches(std::size_t capacity) : branches_(capacity) {}

  /// Removes all nodes, for a new search.
  void clear() noexcept { size_ = 0; }

  /// Adds an open node, unless the memory is full or the node has more than Branch::most_planes.
  void push(double cost, const Vec3& motion, std::span<const HalfSpace> planes) noexcept {
    if (size_ == branches_.size() || planes.size() > Branch::most_planes) return;
    Branch& branch = branches_[size_++];
    std::copy(planes.begin(), planes.end(), branch.plane.begin());
    branch.cost = cost;
    branch.motion = motion;
    branch.count = planes.size();
    branch.is_open = true;
  }

  /// Closes the open node of least cost, the first of equals, and returns it; null if no node is
  /// open. Valid until clear().
  const Branch* pop_nearest() noexcept {
    Branch* nearest = nullptr;
    for (Branch& branch : std::span(branches_).first(size_)) {
      if (branch.is_open && (nearest == nullptr || branch.cost < nearest->cost)) nearest = &branch;
    }
    if (nearest != nullptr) nearest->is_open = false;
    return nearest;
  }

 private:
  std::vector<Branch> branches_;
  std::size_t size_ = 0;
};

}  // namespace keepout
