// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/tool_audit.h"

#include <algorithm>
#include <utility>

namespace keepout::app {
namespace {

/// Returns a tool as the oracle represents it: a robot without joints, whose base is the tip.
monitor::JudgedRobot judged(const ConvexTool& tool) {
  monitor::JudgedBody body{.points = {}, .radius = tool.radius()};
  for (const Vec3& point : tool.points()) body.points.push_back({.link = 0, .position = point});
  return {.table = {}, .bodies = {std::move(body)}};
}

}  // namespace

ToolAudit::ToolAudit(Audit& audit, const ConvexTool& tool, const Vec3& start)
    : audit_(&audit),
      of_core_(tool.points().front()),
      oracle_(audit.tree(), judged(tool), {.position = start}),
      tip_(start),
      // The tool is at most as far from the surface as one of its points.
      clearance_(distance_at(start, 1.001 * audit.distance(start + of_core_) + Audit::touching)),
      is_inside_(is_inside(start, clearance_)) {}

double ToolAudit::distance_at(const Vec3& tip, double reach) {
  oracle_.move_to({}, {.position = tip});
  return oracle_.clearance(0, reach);
}

bool ToolAudit::is_inside(const Vec3& tip, double distance) const {
  return audit_->surface() == SurfaceKind::closed && audit_->side(tip + of_core_) == Side::behind &&
         distance > 0.0;
}

double ToolAudit::clearance_at(const Vec3& tip, double reach) {
  const double distance = distance_at(tip, reach);
  return is_inside(tip, distance) ? -distance : distance;
}

bool ToolAudit::touches(const Vec3& from, double at_from, const Vec3& to, double at_to) {
  const double length = (to - from).norm();
  if (!(at_from > Audit::touching && at_to > Audit::touching)) return true;
  if (at_from + at_to > length) return false;
  const Vec3 middle = 0.5 * (from + to);
  const double at_middle = distance_at(middle, 0.5 * length + std::min(at_from, at_to));
  return touches(from, at_from, middle, at_middle) || touches(middle, at_middle, to, at_to);
}

bool ToolAudit::follow(const Vec3& to) {
  const Vec3 from = std::exchange(tip_, to);
  const double before = clearance_;
  const double length = (to - from).norm();
  clearance_ = distance_at(to, std::max(0.0, before) + length + Audit::touching);
  if (!touches(from, before, to, clearance_)) return false;
  is_inside_ = is_inside(to, clearance_);
  return true;
}

}  // namespace keepout::app
