// SPDX-License-Identifier: BSD-3-Clause
#include "tip_guides.h"

#include <algorithm>
#include <string>
#include <utility>

#include "keepout/activation/planes.h"
#include "keepout/error.h"

namespace keepout {

TipGuides::TipGuides(std::vector<Guide> guides)
    : guides_(std::move(guides)),
      states_(guides_.size()),
      most_excess_(guides_.size()),
      planes_(most_planes_of_a_guide * guides_.size()),
      guide_of_(planes_.capacity()) {
  if (guides_.size() > Guide::most) {
    throw Error("a tip has at most " + std::to_string(Guide::most) + " guides, not " +
                std::to_string(guides_.size()));
  }
  for (const Guide& guide : guides_) {
    const bool is_of_tip = guide.kind() == Guide::Kind::point && guide.link() == 0 &&
                           guide.first().position.isZero(0.0);
    if (is_of_tip) continue;
    throw Error("guide '" + guide.name() +
                "' is for a link of an instrument, which a tip has not: give the tip a guide of a "
                "point without a link, or guard the whole instrument");
  }
}

void TipGuides::open(const Vec3& tip, double recovery) noexcept {
  tip_ = tip;
  recovery_ = recovery;
  planes_.clear();
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    const double excess = guides_[g].region().excess(tip);
    // The tip may leave the boundary by the rounding of its coordinates when it moves along it.
    const double rounding = 1e-15 * (tip.lpNorm<1>() + guides_[g].region().origin().lpNorm<1>());
    states_[g] = {.excess = excess};
    most_excess_[g] = std::max(guides_[g].band(), excess) + rounding;
    if (excess > 0.0) add(g, tip);
  }
}

/// Adds the half-space that touches a region where the tip would be `at`. Returns false if there is
/// no such half-space, as in the middle of the region, or no capacity for it.
bool TipGuides::add(std::size_t g, const Vec3& at) noexcept {
  const Region& region = guides_[g].region();
  const Vec3 into = -region.outward(at);
  if (into.isZero(0.0) || planes_.size() == planes_.capacity()) return false;
  guide_of_[planes_.size()] = g;
  const double offset = into.dot(region.origin() - tip_) - region.radius();
  planes_.push({into, std::min(offset, recovery_), no_triangle});
  return true;
}

bool TipGuides::is_recovering() const noexcept {
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (states_[g].excess > guides_[g].band()) return true;
  }
  return false;
}

bool TipGuides::leads_back() const noexcept {
  return std::any_of(planes_.begin(), planes_.end(),
                     [](const HalfSpace& plane) { return plane.offset > 0.0; });
}

bool TipGuides::relax() noexcept {
  recovery_ = 0.0;
  return let_stand_still(planes_);
}

std::span<const GuideState> TipGuides::states(Relaxation relaxation) noexcept {
  for (GuideState& state : states_) {
    state.relaxed = relaxation != Relaxation::none && state.excess > 0.0;
  }
  return states_;
}

bool TipGuides::all_allow(const Vec3& motion) const noexcept {
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (!(guides_[g].region().excess(at_end(motion)) <= most_excess_[g])) return false;
  }
  return true;
}

double TipGuides::allowed_fraction(const Vec3& motion) const noexcept {
  if (allow(motion)) return 1.0;
  double fraction = 0.0;
  for (double part = 0.5; part > 1e-3; part *= 0.5) {
    if (allow((fraction + part) * motion)) fraction += part;
  }
  return fraction;
}

bool TipGuides::exclude(const Vec3& motion) noexcept {
  const Vec3 end = at_end(motion);
  bool is_excluded = false;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (guides_[g].region().excess(end) > most_excess_[g]) is_excluded = add(g, end) || is_excluded;
  }
  return is_excluded;
}

void TipGuides::note_left_by(const Vec3& motion) noexcept {
  const Vec3 end = at_end(motion);
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    states_[g].limits = states_[g].limits || guides_[g].region().excess(end) > most_excess_[g];
  }
}

}  // namespace keepout
