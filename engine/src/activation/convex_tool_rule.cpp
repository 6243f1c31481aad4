// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/convex_tool_rule.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/activation/planes.h"
#include "keepout/error.h"

namespace keepout {
namespace {

// In tolerances. Triangles are looked for a little beyond the reach of motions.
constexpr double region_beyond = 8.0;
// Nearer than the margin by less than this is at the margin: solvers and positions are rounded.
constexpr double lost_below = 8.0;
// Nearer than this the tool is on the surface: the normal is rounding.
constexpr double touching_within = 2.0;
// Below this a margin cannot be told from nothing.
constexpr double needed_margin = 32.0;

std::unique_ptr<NarrowPhase> or_exact(std::unique_ptr<NarrowPhase> given, const ConvexTool& tool) {
  if (given) return given;
  return std::make_unique<ExactNarrowPhase>(tool);
}

double longest_edge_of(const Mesh* mesh) {
  if (mesh == nullptr) throw Error("a rule for a convex tool needs a mesh");
  return longest_edge(*mesh);
}

}  // namespace

ConvexToolRule::ConvexToolRule(std::shared_ptr<const Mesh> mesh, ConvexTool tool,
                               std::unique_ptr<NarrowPhase> narrow_phase)
    : mesh_(std::move(mesh)),
      tool_(std::move(tool)),
      narrow_phase_(or_exact(std::move(narrow_phase), tool_)),
      longest_edge_(longest_edge_of(mesh_.get())),
      near_(0) {}

void ConvexToolRule::reserve(std::size_t triangles) { near_ = Buffer<Near>(triangles); }

double ConvexToolRule::tolerance(const Surroundings& around) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  return around.rounding +
         1e-12 * (longest_edge_ + bounds.center.norm() + bounds.radius + around.margin);
}

Ball ConvexToolRule::region(const Surroundings& around) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  const Vec3 center = around.tip + bounds.center;
  const double beyond = bounds.radius + around.margin + region_beyond * tolerance(around);
  if (around.searched == Reach::sphere) return {center, around.longest + beyond};
  // Projections of the aim on a convex set that holds 0 lie in the ball over it (Thales).
  return {center + 0.5 * around.aim, 0.5 * around.aim.norm() + beyond};
}

/// By the normal that is proposed, if it proves `enough`; else by the exact one.
ConvexToolRule::Near ConvexToolRule::separated(const Surroundings& around, TriangleId triangle,
                                               double enough) noexcept {
  const Triangle corners = mesh_->triangle(triangle);
  const auto along = [&](const Vec3& n) {
    return Near{n, separation_along(n, tool_, around.tip, corners), triangle};
  };
  const NarrowPhaseAnswer proposed = narrow_phase_->separation(around.tip, corners);
  if (proposed.answered()) {
    const Vec3 n = proposed.separation.normal.normalized();
    const bool is_direction = std::abs(n.squaredNorm() - 1.0) < 1e-12;  // false for NaN
    const Near near = along(n);
    if (is_direction && near.distance >= enough) return near;
  }
  return along(separation(tool_, around.tip, corners).normal);
}

Opening ConvexToolRule::start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept {
  using Stance = Opening::Stance;
  const double tau = tolerance(around);
  if (!(around.margin > needed_margin * tau)) return {Stance::no_margin};
  const double lost = around.margin - lost_below * tau;

  near_.clear();
  const Near* nearest = nullptr;
  for (const Hit& hit : around.hits) {
    near_.push(separated(around, hit.triangle, lost));
    if (near_.overflowed()) return {Stance::over_capacity};
    const Near& last = near_[near_.size() - 1];
    if (nearest == nullptr || last.distance < nearest->distance) nearest = &last;
  }
  if (nearest == nullptr) return {Stance::clear};
  if (!(nearest->distance > touching_within * tau)) return {Stance::touching};

  const bool too_close = nearest->distance < lost;
  const double lift =
      too_close ? std::min(around.recovery, around.margin - nearest->distance) : 0.0;
  const double level = too_close ? nearest->distance + lift : around.margin;
  const double longest = around.reach == Reach::thales ? around.aim.norm() : around.longest;
  for (const Near& near : near_) {
    if (near.distance - longest > level + tau) continue;  // no motion gets there
    double offset = level - near.distance;
    if (!too_close) offset = std::min(offset, 0.0);  // to stand still is always allowed
    planes.push({near.normal, offset, near.triangle});
  }
  if (!too_close) return {Stance::clear};
  return {Stance::too_close, way_out(around, nearest->normal, lift)};
}

Judgement ConvexToolRule::judge(const Surroundings& around, const Vec3& trial,
                                HalfSpaceBuffer& planes) noexcept {
  // Where nothing was looked at, nothing is known.
  const Ball& bounds = tool_.bounding_ball();
  const double from_center = (around.tip + bounds.center + trial - around.ball.center).norm();
  if (!(from_center + bounds.radius + around.margin <= around.ball.radius)) {
    return {Judgement::Verdict::blocked, 0.0};
  }
  return Activation::judge(around, trial, planes);
}

bool ConvexToolRule::relax(HalfSpaceBuffer& planes) const noexcept {
  return let_stand_still(planes);
}

}  // namespace keepout
