// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A node of the branch and bound: planes, and the nearest motion that they allow.
struct Branch {
  /// A choice of more planes than that is not looked into.
  static constexpr std::size_t most_planes = 24;

  double cost;  // distance from the aim [length]
  Vec3 motion;  // [length]

  /// Those that the node was opened with.
  std::span<const HalfSpace> planes() const noexcept { return {planes_.data(), count_}; }

 private:
  friend class Branches;
  std::array<HalfSpace, most_planes> planes_;
  std::size_t count_;
  bool open_;
};

/// The nodes of a search, with memory that is made once. What does not fit is left out: that costs
/// quality and not safety.
class Branches {
 public:
  /// Makes room for that many nodes in a search. Allocates.
  explicit Branches(std::size_t capacity) : branches_(capacity) {}

  /// Forgets all nodes: a new search begins.
  void clear() noexcept { size_ = 0; }

  /// Opens a node; left out when there is no room, or when it has more than Branch::most_planes.
  void push(double cost, const Vec3& motion, std::span<const HalfSpace> planes) noexcept;

  /// The open node of least cost, of equals the first; it is open no longer. Null when there is
  /// none. Valid until clear().
  const Branch* pop_nearest() noexcept;

 private:
  std::vector<Branch> branches_;
  std::size_t size_ = 0;
};

}  // namespace keepout
