// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/convex_tool_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"

namespace keepout {
namespace {

// An approach to a contact takes a few strides with true normals. With proposed ones it may take
// more, so that they are asked for only so often.
constexpr int most_strides = 64;
constexpr int most_proposed_strides = 8;

std::unique_ptr<NarrowPhase> or_exact(std::unique_ptr<NarrowPhase> given, const ConvexTool& tool) {
  if (given) return given;
  return std::make_unique<ExactNarrowPhase>(tool);
}

}  // namespace

ConvexToolRule::ConvexToolRule(ConvexTool tool, std::unique_ptr<NarrowPhase> narrow_phase)
    : tool_(std::move(tool)), narrow_phase_(or_exact(std::move(narrow_phase), tool_)), near_(0) {}

void ConvexToolRule::prepare(Neighborhood& near) {
  ActivationRule::prepare(near);
  near_ = Buffer<Near>(near.room());
}

double ConvexToolRule::tolerance(const CycleProblem& problem) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  return problem.rounding +
         1e-12 * (mesh().longest_edge() + bounds.center.norm() + bounds.radius + problem.margin);
}

Ball ConvexToolRule::region(const CycleProblem& problem) const noexcept {
  const Ball& bounds = tool_.bounding_ball();
  const Ball ends = ends_of_motions(problem);
  return {ends.center + bounds.center,
          ends.radius + bounds.radius + problem.margin + region_beyond * tolerance(problem)};
}

ConvexToolRule::Proof ConvexToolRule::proof_along(const Vec3& normal, const Vec3& position,
                                                  TriangleId triangle) const noexcept {
  return {normal, separation_along(normal, tool_, position, mesh().triangle(triangle))};
}

/// By the normal that is proposed, if it proves more than `enough`; else by the exact one.
ConvexToolRule::Proof ConvexToolRule::proof_of(double enough, const Vec3& position,
                                               TriangleId triangle) noexcept {
  const Triangle corners = mesh().triangle(triangle);
  const NarrowPhaseAnswer proposed = narrow_phase_->separation(position, corners);
  if (proposed.answered()) {
    const Vec3 n = proposed.separation.normal.normalized();
    const Proof proof = proof_along(n, position, triangle);
    const bool is_direction = std::abs(n.squaredNorm() - 1.0) < 1e-12;  // false for NaN
    if (is_direction && proof.distance > enough) return proof;
  }
  return proof_along(separation(tool_, position, corners).normal, position, triangle);
}

Opening ConvexToolRule::open(const CycleProblem& problem, HalfSpaceBuffer&) noexcept {
  const double tau = tolerance(problem);
  if (!(problem.margin > needed_margin * tau)) return {Status::margin_too_small};

  near_.clear();
  const Near* nearest = nullptr;
  for (const Hit& hit : hits()) {
    near_.push({hit.triangle, proof_of(problem.margin, problem.tip, hit.triangle), 0.0, 0.0, 0.0});
    if (near_.overflowed()) return {Status::over_capacity};
    const Near& last = near_[near_.size() - 1];
    if (nearest == nullptr || last.at_start.distance < nearest->at_start.distance) nearest = &last;
  }
  if (nearest == nullptr) return {};

  const Proof closest = nearest->at_start;
  if (closest.distance >= problem.margin - lost_below * tau) {
    for (Near& near : near_) {
      near.clearance = problem.margin;
      near.demand = std::min(problem.margin - demand_below * tau, near.at_start.distance);
      near.floor = std::min(problem.margin - floor_below * tau, near.at_start.distance);
    }
    return {};
  }
  // Not above for NaN.
  if (!(closest.distance > touching_within * tau)) return {Status::touching};
  // Too close already: the mesh shall not come closer, and what comes as close is led off as well.
  const double lift = std::min(problem.recovery, problem.margin - closest.distance);
  for (Near& near : near_) {
    near.clearance = closest.distance + lift;
    near.demand = closest.distance;
    near.floor = closest.distance;
  }
  return {Status::recovering, way_out(problem, closest.normal, lift)};
}

/// Whether a plane that there is already proves that a trial keeps the level.
bool ConvexToolRule::keeps_clear(const Near& near, const CycleProblem& problem, const Vec3& trial,
                                 double level, std::span<const HalfSpace> planes) const noexcept {
  const auto proves = [&](const Proof& proof) {
    return proof.distance >= level && proof.distance + proof.normal.dot(trial) >= level;
  };
  if (proves(near.at_start)) return true;
  return std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return plane.source == near.triangle &&
           proves(proof_along(plane.normal, problem.tip, near.triangle));
  });
}

/// Where a trial first comes down to the level; nothing if it does not. Newton's method from the
/// left on the distance, which is convex in time: each plane proves the way up to the next stride.
std::optional<ConvexToolRule::Contact> ConvexToolRule::first_contact(const Near& near,
                                                                     const CycleProblem& problem,
                                                                     const Vec3& trial,
                                                                     double level) noexcept {
  const double slack = contact_slack * tolerance(problem);
  double time = 0.0;
  Proof proof = near.at_start;
  for (int stride = 0; stride < most_strides; ++stride) {
    const double slope = proof.normal.dot(trial);
    if (proof.distance >= level && proof.distance + (1.0 - time) * slope >= level) return {};
    if (!(proof.distance - level > slack)) break;
    time = std::min(time + (proof.distance - level) / -slope, 1.0);
    const double enough =
        stride < most_proposed_strides ? level + slack : std::numeric_limits<double>::infinity();
    proof = proof_of(enough, problem.tip + time * trial, near.triangle);
  }
  const Proof from_start = proof_along(proof.normal, problem.tip, near.triangle);
  return Contact{time, {proof.normal, near.clearance - from_start.distance, near.triangle}};
}

Judgement ConvexToolRule::judge(const CycleProblem& problem, const Vec3& trial,
                                HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  // Where nothing was looked at, nothing is known.
  const Ball& bounds = tool_.bounding_ball();
  const double from_center = (problem.tip + bounds.center + trial - gathered_ball().center).norm();
  if (!(from_center + bounds.radius + problem.margin <= gathered_ball().radius)) {
    return {Verdict::blocked, 0.0};
  }
  std::optional<Contact> first;
  bool is_answered = false;
  const double length = trial.norm();
  for (const Near& near : near_) {
    if (near.at_start.distance - length >= near.demand) continue;
    const bool answered = has_plane(near.triangle, planes.view());
    const double level = answered ? near.floor : near.demand;
    if (keeps_clear(near, problem, trial, level, planes.view())) continue;
    const std::optional<Contact> contact = first_contact(near, problem, trial, level);
    if (!contact || (first && contact->time >= first->time)) continue;
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
