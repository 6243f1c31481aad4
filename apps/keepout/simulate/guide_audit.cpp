// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/guide_audit.h"

#include <algorithm>
#include <array>

namespace keepout::app {
namespace {

using oracle::JudgedGuide;

/// The rounding error of many cycles, as a fraction of the coordinates.
constexpr double rounding = 1e-12;

JudgedGuide::Kind judged(Guide::Kind kind) {
  switch (kind) {
    case Guide::Kind::point:
      return JudgedGuide::Kind::point;
    case Guide::Kind::axis:
      return JudgedGuide::Kind::axis;
    case Guide::Kind::shaft:
      break;
  }
  return JudgedGuide::Kind::remote_center;
}

JudgedGuide::Region judged(Region::Kind kind) {
  switch (kind) {
    case Region::Kind::half_space:
      return JudgedGuide::Region::half_space;
    case Region::Kind::slab:
      return JudgedGuide::Region::slab;
    case Region::Kind::tube:
      return JudgedGuide::Region::tube;
    case Region::Kind::ball:
      break;
  }
  return JudgedGuide::Region::ball;
}

/// Returns the excess of the tip of a MotionConstraint, which is link 0.
double excess_at(const JudgedGuide& guide, const Vec3& tip) {
  using Real = monitor::LinkFrame::Real;
  const std::array links{monitor::LinkFrame{.axes = Eigen::Matrix<Real, 3, 3>::Identity(),
                                            .origin = tip.cast<Real>()}};
  return excess(guide, links);
}

}  // namespace

std::vector<JudgedGuide> judged_guides(std::span<const Guide> guides) {
  std::vector<JudgedGuide> all;
  for (const Guide& guide : guides) {
    const Region& region = guide.region();
    all.push_back({.kind = judged(guide.kind()),
                   .first = {guide.first().link, guide.first().position},
                   .second = {guide.second().link, guide.second().position},
                   .region = judged(region.kind()),
                   .origin = region.origin(),
                   .direction = region.direction(),
                   .radius = region.radius(),
                   .band = guide.band()});
  }
  return all;
}

GuideAudit::GuideAudit(std::span<const Guide> guides, const Vec3& start)
    : guides_(judged_guides(guides)), allowed_(guides_.size()) {
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    const double excess = excess_at(guides_[g], start);
    allowed_[g] = std::max(guides_[g].band, excess);
    excess_ = std::max(excess_, excess);
  }
}

bool GuideAudit::follow(const Vec3& to) {
  bool is_left = false;
  excess_ = -std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    const double excess = excess_at(guides_[g], to);
    const double slack = rounding * (to.lpNorm<1>() + guides_[g].origin.lpNorm<1>());
    is_left |= !(excess <= allowed_[g] + slack);
    allowed_[g] = std::max(guides_[g].band, std::min(allowed_[g], excess));
    excess_ = std::max(excess_, excess);
  }
  return is_left;
}

}  // namespace keepout::app
