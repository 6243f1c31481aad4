// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "keepout/solvers/active_set.h"
#include "rule.h"

namespace keepout::peers {

/// Finds the nearest motion within half-spaces, for the rules that are not keepout's own.
class NearestMotion {
 public:
  NearestMotion() { solver_.reserve(3, capacity_); }

  /// Removes all planes, and adds those of the corridor. A tip outside it moves no farther out.
  void begin(const std::optional<Corridor>& corridor, const Vec3& tip);

  /// Allows only motions d with normal . d >= offset. Precondition: `normal` is a unit vector.
  void add(const Vec3& normal, double offset) { planes_.push_back({normal, offset, no_triangle}); }

  /// Returns the allowed motion nearest to the desired one; zero if the planes contradict each
  /// other.
  Vec3 to(const Vec3& desired);

 private:
  ActiveSet solver_;
  int capacity_ = 64;
  std::vector<HalfSpace> planes_;
  std::vector<double> rows_, bounds_;
};

}  // namespace keepout::peers
