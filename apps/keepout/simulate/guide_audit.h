// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "keepout/oracle/judged_guide.h"
#include "keepout/step/guide.h"

namespace keepout::app {

/// Returns the guides in the form that the oracle uses.
std::vector<oracle::JudgedGuide> judged_guides(std::span<const Guide> guides);

/// Follows a tip, and judges its guides by the guarantees of docs/guides.md. A tip inside a region
/// leaves it by at most the guide's band, and a tip outside moves no farther out. Regions are the
/// oracle's. An excess is convex, so the ends of a straight motion decide for all of it.
class GuideAudit {
 public:
  GuideAudit(std::span<const Guide> guides, const Vec3& start);

  /// Moves the tip straight to `to`. Returns true if it leaves a guide by more than guaranteed, and
  /// by more than rounding.
  bool follow(const Vec3& to);

  /// Returns the largest distance of the tip from a region; below 0 inside all of them, minus
  /// infinity without guides. [mm]
  double excess() const noexcept { return excess_; }

 private:
  std::vector<oracle::JudgedGuide> guides_;
  std::vector<double> allowed_;  // the allowed excess of each guide [mm]
  double excess_ = -std::numeric_limits<double>::infinity();
};

}  // namespace keepout::app
