// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <algorithm>
#include <utility>

#include "certified_search.h"
#include "certified_terms.h"
#include "keepout/activation/planes.h"
#include "tolerance_ladder.h"

namespace keepout {
namespace {

// How often a cycle may ask for a proof, all told: some hundreds of milliseconds. What is in a
// hurry has the form that searches.
constexpr std::size_t most_proofs = std::size_t{1} << 22;

}  // namespace

CertifiedRule::CertifiedRule(std::shared_ptr<const Mesh> mesh)
    : mesh_(std::move(mesh)),
      longest_edge_(mesh_->longest_edge()),
      terms_(std::make_unique<CertifiedTerms>()),
      facets_(0) {}

CertifiedRule::~CertifiedRule() = default;

std::unique_ptr<Activation> CertifiedRule::searching(const SpatialIndex& index) const {
  const auto* tree = dynamic_cast<const WideBvh*>(&index);
  if (tree == nullptr) return nullptr;
  return std::make_unique<CertifiedSearch>(mesh_, *tree);
}

void CertifiedRule::reserve(std::size_t triangles) { facets_ = Buffer<Facet>(triangles); }

double CertifiedRule::tolerance(const Surroundings& around) const noexcept {
  return certified_tolerance(around, longest_edge_);
}

Ball CertifiedRule::region(const Surroundings& around) const noexcept {
  return certified_region(around, tolerance(around));
}

Opening CertifiedRule::start(const Surroundings& around, HalfSpaceBuffer&) noexcept {
  using Stance = Opening::Stance;
  const double tau = tolerance(around);
  if (!(around.margin > needed_margin * tau)) return {Stance::no_margin};

  facets_.clear();
  proofs_ = 0;
  const Facet* nearest = nullptr;
  for (const Hit& hit : around.hits) {
    facets_.push(Facet(mesh_->triangle(hit.triangle), around.tip, hit.triangle));
    if (facets_.overflowed()) return {Stance::over_capacity};
    const Facet& facet = facets_[facets_.size() - 1];
    if (nearest == nullptr || facet.distance() < nearest->distance() ||
        (facet.distance() == nearest->distance() && facet.before(*nearest))) {
      nearest = &facet;
    }
  }
  *terms_ = CertifiedTerms::keeping(around.margin, tau);
  const std::optional<double> distance = known_distance(nearest, around.margin, tau);
  if (nearest == nullptr || nearest->distance() >= around.margin - lost_below * tau) {
    return {.stance = Stance::clear, .distance = distance};
  }
  if (nearest->distance() <= touching_within * tau) {
    return {.stance = Stance::touching, .distance = distance};
  }
  // Too close already: the mesh shall not come closer, and what comes as close is led off as well.
  const double lift = std::min(around.recovery, around.margin - nearest->distance());
  *terms_ = CertifiedTerms::leading_off(nearest->distance(), lift, tau);
  return {Stance::too_close, way_out(around, nearest->normal(), lift), distance};
}

Judgement CertifiedRule::judge(const Surroundings& around, const Vec3& trial,
                               HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  Contact first{2.0, {Vec3::Zero(), 0.0, no_triangle}};
  const Facet* found = nullptr;
  const double length = trial.norm();
  for (const Facet& facet : facets_) {
    if (facet.distance() - length > terms_->demand(facet)) continue;
    ++proofs_;
    if (terms_->is_covered(facet.corners(), trial, planes.view())) continue;
    const bool answered = has_plane(facet.source(), planes.view());
    if (terms_->keeps_clear(facet, trial, answered)) continue;
    const Contact contact = terms_->contact(facet, trial, first.time);
    const bool sooner = contact.time < first.time ||
                        (contact.time == first.time && found != nullptr && facet.before(*found));
    if (!sooner) continue;
    first = contact;
    found = &facet;
  }
  if (found == nullptr) return {Verdict::accepted};
  const double free_share = std::clamp(first.time, 0.0, 1.0);
  if (has_plane(first.plane.source, planes.view()) || planes.size() >= most_planes ||
      proofs_ > most_proofs) {
    return {Verdict::blocked, free_share};
  }
  planes.push(terms_->answer(*found, around, trial, first.plane));
  return {Verdict::objected, free_share};
}

bool CertifiedRule::relax(HalfSpaceBuffer& planes) const noexcept {
  // Offsets above 0 lead back to the full margin. Standing still is always allowed.
  return let_stand_still(planes);
}

bool CertifiedRule::turn(const Surroundings& around, std::span<const HalfSpace> planes,
                         HalfSpaceBuffer& turned) noexcept {
  const auto its_facet = [this](TriangleId source) -> const Facet& { return facet(source); };
  return terms_->turn_all(around, planes, its_facet, turned);
}

void CertifiedRule::ways_around(const Surroundings&, TriangleId source,
                                HalfSpaceBuffer& ways) const noexcept {
  if (source != no_triangle) terms_->ways_around(facet(source), ways);
}

const Facet& CertifiedRule::facet(TriangleId source) const noexcept {
  return *std::lower_bound(facets_.begin(), facets_.end(), source,
                           [](const Facet& one, TriangleId id) { return one.source() < id; });
}

}  // namespace keepout
