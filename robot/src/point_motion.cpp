// SPDX-License-Identifier: BSD-3-Clause
#include "point_motion.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

// In looks: a chain is placed in a third of a microsecond.
constexpr std::size_t work_of_place = 4;

}  // namespace

PointMotion::PointMotion(const Instrument& instrument, Budget& budget)
    : instrument_(&instrument), budget_(&budget), places_(cells + 1) {
  straight_.fill(Vec3::Zero());
}

void PointMotion::start(std::span<const double> q) noexcept {
  ++motion_;
  std::copy(q.begin(), q.end(), q_.begin());
  budget_->spend(work_of_place);
  instrument_->chain().forward_kinematics(q, start_);
  fill(start_, places_[0]);
}

void PointMotion::move(const JointVector& increment, CertifiedMotion which) noexcept {
  ++motion_;
  increment_ = increment;
  which_ = which;
  const std::span<const LinkPoint> points = instrument_->points();
  const auto n = static_cast<std::size_t>(instrument_->chain().size());
  budget_->spend(1 + points.size() / 4);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec3& here = at_start()[p];
    if (which == CertifiedMotion::actual) {
      bounds_[p] = motion_bounds(start_, {increment_.data(), n}, points[p].link, here);
      continue;
    }
    straight_[p].setZero();
    for (int k = 1; k <= points[p].link; ++k) {
      straight_[p] +=
          increment_[static_cast<std::size_t>(k - 1)] * start_.linear(k, points[p].link, here);
    }
    bounds_[p] = {straight_[p].norm(), 0.0};
  }
}

const Vec3* PointMotion::at(int cell) noexcept {
  Place& place = places_[static_cast<std::size_t>(cell)];
  if (cell == 0 || place.motion == motion_) return place.points.data();
  place.motion = motion_;
  const double share = static_cast<double>(cell) / cells;
  if (which_ == CertifiedMotion::linearised) {
    for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
      place.points[p] = at_start()[p] + share * straight_[p];
    }
    return place.points.data();
  }
  budget_->spend(work_of_place);
  place_at(share, state_);
  placed_motion_ = motion_;
  placed_share_ = share;
  fill(state_, place);
  return place.points.data();
}

Pose PointMotion::flange_at(double share) noexcept {
  if (placed_motion_ != motion_ || placed_share_ != share) {
    budget_->spend(work_of_place);
    place_at(share, state_);
    placed_motion_ = motion_;
    placed_share_ = share;
  }
  return state_.flange();
}

void PointMotion::place(int cell, ChainState& state) const noexcept {
  place_at(static_cast<double>(cell) / cells, state);
}

void PointMotion::place_at(double share, ChainState& state) const noexcept {
  const auto n = static_cast<std::size_t>(instrument_->chain().size());
  JointVector q;
  for (std::size_t k = 0; k < n; ++k) q[k] = q_[k] + share * increment_[k];
  instrument_->chain().forward_kinematics({q.data(), n}, state);
}

void PointMotion::fill(const ChainState& state, Place& place) const noexcept {
  const std::span<const LinkPoint> points = instrument_->points();
  for (std::size_t p = 0; p < points.size(); ++p) {
    place.points[p] = state.at(points[p].link, points[p].position);
  }
}

}  // namespace keepout
