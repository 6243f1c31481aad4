// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/convex_tool_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "../../geometry/direction_of.h"
#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"

namespace keepout {
namespace {

// A search for a contact takes a few strides with exact normals. Proposed normals may need more, so
// their number is limited.
constexpr int most_strides = 64;
constexpr int most_proposed_strides = 8;

/// Returns the work units of a direction that is tried for all points of a tool.
std::size_t direction_units(const ConvexTool& tool) noexcept {
  return (1 + tool.points().size() / 16) * work::tool_direction;
}

/// Returns the work units of the exact kernel, if a tool and a triangle are apart.
std::size_t separation_units(const ConvexTool& tool) noexcept {
  return work::tool_separation + tool.points().size() * work::tool_point;
}

/// Returns the additional work units of the exact kernel, if they overlap.
std::size_t overlap_units(const ConvexTool& tool) noexcept {
  const std::size_t directions = 1 + tool.face_normals().size() + 3 * tool.edge_directions().size();
  return separation_units(tool) + directions * direction_units(tool);
}

std::unique_ptr<NarrowPhase> or_exact(std::unique_ptr<NarrowPhase> given, const ConvexTool& tool) {
  if (given) return given;
  return std::make_unique<ExactNarrowPhase>(tool);
}

}  // namespace

ConvexToolRule::ConvexToolRule(ConvexTool tool, std::unique_ptr<NarrowPhase> narrow_phase)
    : tool_(std::move(tool)),
      narrow_phase_(or_exact(std::move(narrow_phase), tool_)),
      near_(0),
      suspects_(0) {}

void ConvexToolRule::prepare(Neighborhood& neighborhood) {
  ActivationRule::prepare(neighborhood);
  near_ = Buffer<Near>(neighborhood.room());
  suspects_ = Buffer<Suspect>(neighborhood.room());
}

double ConvexToolRule::tolerance(const RuleInput& input) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  return input.rounding +
         1e-12 * (mesh().longest_edge() + bounds.center.norm() + bounds.radius + input.clearance);
}

Ball ConvexToolRule::region(const RuleInput& input) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  const Ball ends = searched_ends(input);
  return {ends.center + bounds.center,
          ends.radius + bounds.radius + input.clearance + region_beyond * tolerance(input)};
}

ConvexToolRule::Proof ConvexToolRule::proof_along(const Vec3& normal, const Vec3& position,
                                                  TriangleId triangle) const noexcept {
  return {normal, separation_along(normal, tool_, position, mesh().triangle(triangle))};
}

/// Returns the proof along the direction from the triangle to the middle of the tool. It is cheap,
/// and enough for most triangles.
ConvexToolRule::Proof ConvexToolRule::quick_proof(const Hit& hit,
                                                  const Vec3& position) const noexcept {
  const Vec3 on_triangle = gathered_ball().center + hit.closest.offset - position;
  Vec3 middle = tool_.bounding_ball().center;
  if (tool_.points().size() == 2) {
    const Vec3& from = tool_.points().front();
    const Vec3 along = tool_.points().back() - from;
    const double share = along.dot(on_triangle - from) / along.squaredNorm();
    middle = from + std::clamp(share, 0.0, 1.0) * along;
  }
  return proof_along(direction_of(middle - on_triangle), position, hit.triangle);
}

/// Returns the proof by the proposed normal if it proves more than `enough`; otherwise the proof by
/// the exact normal.
ConvexToolRule::Proof ConvexToolRule::proof_of(double enough, const Vec3& position,
                                               TriangleId triangle) noexcept {
  budget().spend(separation_units(tool_));
  const Triangle corners = mesh().triangle(triangle);
  const NarrowPhaseAnswer proposed = narrow_phase_->separation(position, corners);
  if (proposed.answered()) {
    const Vec3 n = proposed.separation.normal.normalized();
    const Proof proof = proof_along(n, position, triangle);
    const bool is_direction = std::abs(n.squaredNorm() - 1.0) < 1e-12;  // false for NaN
    if (is_direction && proof.distance > enough) return proof;
  }
  if (!narrow_phase_->is_exact()) budget().spend(separation_units(tool_));
  const Separation exact =
      narrow_phase_->is_exact() ? proposed.separation : separation(tool_, position, corners);
  if (exact.distance <= -tool_.radius()) budget().spend(overlap_units(tool_));
  return proof_along(exact.normal, position, triangle);
}

Opening ConvexToolRule::open(const RuleInput& input, HalfSpaceBuffer&) noexcept {
  const double tau = tolerance(input);
  if (!(input.clearance > needed_clearance * tau)) return {Status::margin_too_small};

  near_.clear();
  const Near* nearest = nullptr;
  const Ball ends = searched_ends(input);
  const double longest = (ends.center - input.tip).norm() + ends.radius + region_beyond * tau;
  budget().spend(hits().size() * direction_units(tool_));
  for (const Hit& hit : hits()) {
    if (budget().is_spent()) return {budget().failure()};
    Near near{hit.triangle, quick_proof(hit, input.tip), false};
    if (near.at_start.distance > input.clearance + longest) continue;  // no motion can reach it
    if (!(near.at_start.distance > input.clearance)) {
      near.at_start = proof_of(input.clearance, input.tip, hit.triangle);
      near.is_refined = true;
      if (!(near.at_start.distance > touching_within * tau)) return {Status::touching};
    }
    near_.push(near);
    if (near_.overflowed()) return {Status::over_capacity};
    const Near& last = near_[near_.size() - 1];
    if (nearest == nullptr || last.at_start.distance < nearest->at_start.distance) nearest = &last;
  }
  if (nearest == nullptr) return {};

  const Proof closest = nearest->at_start;
  if (closest.distance >= input.clearance - lost_below * tau) {
    for (Near& near : near_) {
      near.plane_level = input.clearance;
      near.demand = std::min(input.clearance - demand_below * tau, near.at_start.distance);
      near.floor = std::min(input.clearance - floor_below * tau, near.at_start.distance);
    }
    return {};
  }
  // No triangle may come closer than the nearest one, and all of them retreat.
  const double lift = std::min(input.recovery, input.clearance - closest.distance);
  for (Near& near : near_) {
    near.plane_level = closest.distance + lift;
    near.demand = closest.distance;
    near.floor = closest.distance;
  }
  return {Status::recovering, retreat_target(input, closest.normal, lift)};
}

/// Fills suspects_ with all triangles that the trial may come too close to.
void ConvexToolRule::find_suspects(const RuleInput& input, const Vec3& trial) noexcept {
  const double length = trial.norm();
  const double slack = contact_slack * tolerance(input);
  suspects_.clear();
  for (Near& near : near_) {
    if (near.at_start.distance - length >= near.demand) continue;
    const double left = near.at_start.distance - near.demand - slack;
    const double slope = near.at_start.normal.dot(trial);
    suspects_.push({&near, left > 0.0 && slope < 0.0 ? left / -slope : 0.0});
  }
  budget().spend((1 + near_.size() / 8) * work::scan + suspects_.size() * work::tool_suspect);
  std::sort(suspects_.begin(), suspects_.end(), [](const Suspect& x, const Suspect& y) {
    return x.earliest < y.earliest || (x.earliest == y.earliest && x.near < y.near);
  });
}

/// Returns true if one of the planes, or the proof at the start, proves the level on the trial.
bool ConvexToolRule::keeps_clear(Near& near, const RuleInput& input, const Vec3& trial,
                                 double level, std::span<const HalfSpace> planes) noexcept {
  const auto proves = [&](const Proof& proof) {
    return proof.distance >= level && proof.distance + proof.normal.dot(trial) >= level;
  };
  if (proves(near.at_start)) return true;
  const bool is_proven = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return plane.source == near.triangle &&
           proves(proof_along(plane.normal, input.tip, near.triangle));
  });
  if (is_proven || near.is_refined) return is_proven;
  near.at_start = proof_of(input.clearance, input.tip, near.triangle);
  near.is_refined = true;
  return proves(near.at_start);
}

/// Returns the contact at which a trial first comes down to the level, if that is before `latest`.
/// Uses Newton's method from the left on the distance, which is convex in time: each plane proves
/// the motion up to the next stride.
std::optional<ConvexToolRule::Contact> ConvexToolRule::first_contact(const Near& near,
                                                                     const RuleInput& input,
                                                                     const Vec3& trial,
                                                                     double level,
                                                                     double latest) noexcept {
  const double slack = contact_slack * tolerance(input);
  double time = 0.0;
  Proof proof = near.at_start;
  for (int stride = 0; stride < most_strides; ++stride) {
    const double slope = proof.normal.dot(trial);
    if (proof.distance >= level && proof.distance + (1.0 - time) * slope >= level) return {};
    if (!(proof.distance - level > slack)) break;
    if (time > latest || proof.distance + (latest - time) * slope >= level + slack) return {};
    time = std::min(time + (proof.distance - level) / -slope, 1.0);
    const double enough =
        stride < most_proposed_strides ? level + slack : std::numeric_limits<double>::infinity();
    proof = proof_of(enough, input.tip + time * trial, near.triangle);
  }
  const Proof from_start = proof_along(proof.normal, input.tip, near.triangle);
  return Contact{time, {proof.normal, near.plane_level - from_start.distance, near.triangle}};
}

Judgement ConvexToolRule::judge(const RuleInput& input, const Vec3& trial,
                                HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  // Triangles outside the query are unknown.
  const Ball& bounds = tool_.bounding_ball();
  const double from_center = (input.tip + bounds.center + trial - gathered_ball().center).norm();
  if (!(from_center + bounds.radius + input.clearance <= gathered_ball().radius)) {
    return {Verdict::blocked, 0.0};
  }
  find_suspects(input, trial);
  std::optional<Contact> first;
  bool is_answered = false;
  for (const auto& [near, earliest] : suspects_) {
    if (first && earliest > first->time) break;
    // If the budget is spent, some triangles are not examined, so there is no conclusion.
    if (budget().is_spent()) return {Verdict::blocked, 0.0};
    budget().spend((planes.size() / 64) * work::scan);
    const bool answered = has_plane(near->triangle, planes.view());
    const double level = answered ? near->floor : near->demand;
    if (keeps_clear(*near, input, trial, level, planes.view())) continue;
    const std::optional<Contact> contact =
        first_contact(*near, input, trial, level, first ? first->time : 1.0);
    if (!contact) continue;
    const auto is_before = [](const Contact& x, const Contact& y) {
      return x.time < y.time || (x.time == y.time && x.plane.source < y.plane.source);
    };
    if (first && !is_before(*contact, *first)) continue;
    first = contact;
    is_answered = answered;
  }
  if (!first) return {Verdict::accepted};
  if (is_answered || planes.size() >= most_cutting_planes) return {Verdict::blocked, first->time};
  planes.push(first->plane);
  return {Verdict::objected, first->time};
}

bool ConvexToolRule::relax(HalfSpaceBuffer& planes) noexcept { return let_stand_still(planes); }

}  // namespace keepout
