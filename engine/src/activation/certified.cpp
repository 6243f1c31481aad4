// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/activation/planes.h"

namespace keepout {
namespace {

// In units of the tolerance tau. Solvers and the rounding of positions leave errors far below one
// tau. Each step of the ladder is one: what a free motion may lose, what a motion along a plane may
// lose on top, and where the margin counts as lost. Planes aim at the full margin, so that whatever
// was lost comes back.
constexpr double demand_below = 1.0;
constexpr double floor_below = 2.0;
constexpr double lost_below = 2.75;
constexpr double touching_within = 4.0;
constexpr double needed_margin = 8.0;
constexpr double region_beyond = 8.0;

constexpr double proof_slack = 1.0 / 64.0;   // of keeps_clear
constexpr double contact_slack = 1.0 / 8.0;  // of first_contact: small beside demand_below

// A plane that an accepted motion is farther from, as a share of it, has not shaped it.
constexpr double idle_slack = 1e-6;

// How often a cycle may ask for a proof, all told: some tens of milliseconds.
constexpr std::size_t most_proofs = std::size_t{1} << 18;

// A cycle's planes are few; under the tip of a cone of 400 faces some hundred; more are a loop that
// does not end.
constexpr std::size_t most_planes = 192;

bool has_plane(TriangleId source, std::span<const HalfSpace> planes) noexcept {
  return std::any_of(planes.begin(), planes.end(),
                     [&](const HalfSpace& plane) { return plane.source == source; });
}

}  // namespace

CertifiedRule::CertifiedRule(std::shared_ptr<const Mesh> mesh)
    : mesh_(std::move(mesh)), longest_edge_(longest_edge(*mesh_)), near_(0) {}

void CertifiedRule::reserve(std::size_t triangles) { near_ = Buffer<Near>(triangles); }

double CertifiedRule::tolerance(const Surroundings& around) const noexcept {
  return 2e-10 * (longest_edge_ + around.radius + around.margin) + 4e-16 * around.tip.lpNorm<1>();
}

Ball CertifiedRule::region(const Surroundings& around) const noexcept {
  const double beyond = around.margin + region_beyond * tolerance(around);
  if (around.searched == Reach::sphere) return {around.tip, around.longest + beyond};
  // Projections of the aim on a convex set that holds 0 lie in the ball over it (Thales).
  return {around.tip + 0.5 * around.aim, 0.5 * around.aim.norm() + beyond};
}

Opening CertifiedRule::start(const Surroundings& around, HalfSpaceBuffer&) noexcept {
  using Stance = Opening::Stance;
  const double tau = tolerance(around);
  if (!(around.margin > needed_margin * tau)) return {Stance::no_margin};

  near_.clear();
  proofs_ = 0;
  const Facet* nearest = nullptr;
  for (const Hit& hit : around.hits) {
    near_.push({Facet(mesh_->triangle(hit.triangle), around.tip, hit.triangle), 0.0, 0.0, 0.0});
    if (near_.overflowed()) return {Stance::over_capacity};
    const Facet& facet = near_[near_.size() - 1].facet;
    if (nearest == nullptr || facet.distance() < nearest->distance() ||
        (facet.distance() == nearest->distance() && facet.before(*nearest))) {
      nearest = &facet;
    }
  }
  if (nearest == nullptr) return {Stance::clear};

  const double lost = around.margin - lost_below * tau;
  if (nearest->distance() >= lost) {
    for (Near& one : near_) {
      const double distance = one.facet.distance();
      one.target = around.margin;
      one.demand = std::min(around.margin - demand_below * tau, distance);
      one.floor = std::min(around.margin - floor_below * tau, distance);
    }
    return {Stance::clear};
  }
  if (nearest->distance() <= touching_within * tau) return {Stance::touching};
  // Too close already: the mesh shall not come closer, and what comes as close is led off as well.
  const double lift = std::min(around.recovery, around.margin - nearest->distance());
  for (Near& one : near_) {
    one.target = nearest->distance() + lift;
    one.demand = nearest->distance();
    one.floor = nearest->distance();
  }
  return {Stance::too_close, way_out(around, nearest->normal(), lift)};
}

Judgement CertifiedRule::judge(const Surroundings& around, const Vec3& trial,
                               HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  const double tau = tolerance(around);
  Contact first{2.0, {Vec3::Zero(), 0.0, no_triangle}};
  const Near* found = nullptr;
  const double length = trial.norm();
  for (const Near& one : near_) {
    if (one.facet.distance() - length > one.demand) continue;
    ++proofs_;
    const bool answered = has_plane(one.facet.source(), planes.view());
    const double level = answered ? one.floor : one.demand;
    if (keeps_clear(one.facet, trial, level, proof_slack * tau)) continue;
    const Contact contact =
        first_contact(one.facet, trial, one.target, contact_slack * tau, first.time);
    const bool sooner =
        contact.time < first.time ||
        (contact.time == first.time && found != nullptr && one.facet.before(found->facet));
    if (!sooner) continue;
    first = contact;
    found = &one;
  }
  if (found == nullptr) return {Verdict::accepted};
  const double free_share = std::clamp(first.time, 0.0, 1.0);
  if (has_plane(first.plane.source, planes.view()) || planes.size() >= most_planes ||
      proofs_ > most_proofs) {
    return {Verdict::blocked, free_share};
  }
  planes.push(answer(around, *found, trial, first.plane));
  return {Verdict::objected, free_share};
}

bool CertifiedRule::relax(HalfSpaceBuffer& planes) const noexcept {
  // Offsets above 0 lead back to the full margin. Standing still is always allowed.
  return let_stand_still(planes);
}

/// The plane for a triangle in the way: that of the contact, which allows standing still. Where a
/// motion is to be kept, the plane that proves it clear, turned to where the trial ends.
HalfSpace CertifiedRule::answer(const Surroundings& around, const Near& in_the_way,
                                const Vec3& trial, const HalfSpace& contact) const noexcept {
  if (around.kept.isZero(0.0)) return contact;
  const std::optional<Vec3> proof = proof_of_clearance(
      in_the_way.facet, around.kept, in_the_way.floor, proof_slack * tolerance(around));
  if (!proof) return contact;
  HalfSpace plane{*proof, in_the_way.facet.support(*proof) + in_the_way.target, contact.source};
  turn(around, in_the_way, trial, plane);
  return plane;
}

bool CertifiedRule::turn(const Surroundings& around, std::span<const HalfSpace> planes,
                         HalfSpaceBuffer& turned) noexcept {
  bool changed = false;
  for (const HalfSpace& plane : planes) {
    if (plane.normal.dot(around.kept) - plane.offset > idle_slack * around.aim.norm()) continue;
    turned.push(plane);
    if (plane.source == no_triangle) continue;  // not a triangle's but the motion sphere's
    HalfSpace& its = turned[turned.size() - 1];
    turn(around, near(plane.source), around.kept, its);
    changed = changed || its.normal != plane.normal;
  }
  return changed;
}

/// Turns a plane towards the normal at the end of a motion, as far as it goes on allowing what is
/// kept, and standing still.
void CertifiedRule::turn(const Surroundings& around, const Near& its, const Vec3& towards,
                         HalfSpace& plane) const noexcept {
  double distance = 0.0;
  const Vec3 old = plane.normal;
  const Vec3 wanted = its.facet.normal_at(towards, distance);
  const double slack = proof_slack * tolerance(around);
  const double least_at_0 = std::min(-plane.offset, 0.0) - slack;
  const double least_at_end = std::min(old.dot(around.kept) - plane.offset, 0.0) - slack;
  const auto turn_by = [&](double theta) {
    const Vec3 blend = (1.0 - theta) * old + theta * wanted;
    const double length = blend.norm();
    if (!(length > 1e-3)) return false;  // all but opposite: no direction in between
    const Vec3 n = blend / length;
    const double offset = its.facet.support(n) + its.target;
    if (-offset < least_at_0 || n.dot(around.kept) - offset < least_at_end) return false;
    plane.normal = n;
    plane.offset = offset;
    return true;
  };
  if (turn_by(1.0)) return;
  // The normals that allow both are a convex cone: a bisection finds how far it reaches.
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 16; ++i) {
    const double middle = 0.5 * (low + high);
    (turn_by(middle) ? low : high) = middle;
  }
}

void CertifiedRule::ways_around(const Surroundings& around, TriangleId source,
                                HalfSpaceBuffer& ways) const noexcept {
  if (source == no_triangle) return;
  const Near& its = near(source);
  const double slack = proof_slack * tolerance(around);
  const auto add = [&](const Vec3& n) {
    const double offset = its.facet.support(n) + its.target;
    if (!n.isZero(0.0) && offset <= slack) ways.push({n, offset, source});
  };
  add(its.facet.face_normal());
  for (int edge = 0; edge < 3; ++edge) add(its.facet.normal_around(edge, its.target));
}

const CertifiedRule::Near& CertifiedRule::near(TriangleId source) const noexcept {
  return *std::lower_bound(near_.begin(), near_.end(), source, [](const Near& near, TriangleId id) {
    return near.facet.source() < id;
  });
}

}  // namespace keepout
