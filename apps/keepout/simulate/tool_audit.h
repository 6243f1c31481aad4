// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/convex_tool.h"
#include "keepout/oracle/instrument_oracle.h"
#include "simulate/audit.h"

namespace keepout::app {

/// Follows a convex tool, and reports its clearance and whether it touches the surface. Like an
/// Audit, it takes distances and the inside of a closed surface from the oracle, which shares no
/// code with the rule that guards the tool.
class ToolAudit {
 public:
  /// `audit` must outlive this object. `start`: the position of the tip.
  ToolAudit(Audit& audit, const ConvexTool& tool, const Vec3& start);

  /// Moves the tip straight to `to`. Returns true unless the tool is proved not to touch the
  /// surface on the whole motion. A distance changes no faster than the tip moves, so the distances
  /// at both ends prove the part between them; otherwise the part is halved.
  bool follow(const Vec3& to);

  /// Returns the distance from the tool to the surface, with a relative error of 1e-9. It is
  /// negative if the tool is inside a closed surface or the surface reaches into the tool, and
  /// minus the radius if the tool's core touches the surface. [mm]
  double clearance() const noexcept { return is_inside_ ? -clearance_ : clearance_; }

  /// Returns the clearance of the tool with its tip at `tip`; infinity if it is more than `reach`.
  /// [mm]
  double clearance_at(const Vec3& tip, double reach);

 private:
  double distance_at(const Vec3& tip, double reach);
  bool touches(const Vec3& from, double at_from, const Vec3& to, double at_to);
  bool is_inside(const Vec3& tip, double distance) const;

  Audit* audit_;
  Vec3 of_core_;  // a point of the core, from the tip
  oracle::InstrumentOracle oracle_;
  Vec3 tip_;
  double clearance_;  // unsigned [mm]
  bool is_inside_ = false;
};

}  // namespace keepout::app
