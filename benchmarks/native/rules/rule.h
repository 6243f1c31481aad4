// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "keepout/index/spatial_index.h"

namespace keepout::peers {

/// With each rule, a tip closer than the margin retreats by at most this in a cycle. [mm]
inline constexpr double recovery = 0.05;

/// All points within `half_width` [mm] of the plane through `point` with the unit `normal`.
struct Corridor {
  Vec3 point;
  Vec3 normal;
  double half_width;
};

/// The task of a rule: keep the tip, a point, away from a mesh, and in a corridor if there is one.
struct Task {
  std::shared_ptr<const SpatialIndex> index;
  double margin;  // required clearance [mm]
  double radius;  // of the motion sphere: no desired motion is longer [mm]
  std::optional<Corridor> corridor = std::nullopt;

  const Mesh& mesh() const noexcept { return index->mesh(); }
};

/// Returns the allowed motion of a tip. Make one for each trial: a rule may remember earlier
/// cycles.
class Rule {
 public:
  virtual ~Rule() = default;

  /// Returns the allowed motion for a tip at `tip` and a desired motion. [mm]
  virtual Vec3 step(const Vec3& tip, const Vec3& desired) = 0;
};

}  // namespace keepout::peers
