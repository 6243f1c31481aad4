// SPDX-License-Identifier: BSD-3-Clause
#include "point_motion.h"

#include <algorithm>

namespace keepout {
PointMotion::PointMotion(const Instrument& instrument, Budget& budget)
    : instrument_(&instrument), budget_(&budget), positions_(last_knot + 1) {
  straight_.fill(Vec3::Zero());
}

void PointMotion::begin_cycle(std::span<const double> q) noexcept {
  ++number_;
  std::copy(q.begin(), q.end(), q_.begin());
  budget_->spend(work::kinematics);
  instrument_->chain().forward_kinematics(q, start_);
  fill(start_, positions_[0]);
}

void PointMotion::set_trial(const JointVector& increment, CertifiedMotion which) noexcept {
  ++number_;
  increment_ = increment;
  which_ = which;
  const std::span<const LinkPoint> points = instrument_->points();
  const auto n = static_cast<std::size_t>(instrument_->chain().size());
  budget_->spend((1 + points.size() / 4) * work::four_points);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec3& here = points_at_start()[p];
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

void PointMotion::compute(int knot, Positions& there) noexcept {
  there.motion_number = number_;
  const double fraction = static_cast<double>(knot) / last_knot;
  if (which_ == CertifiedMotion::linearized) {
    for (std::size_t p = 0; p < instrument_->points().size(); ++p) {
      there.points[p] = points_at_start()[p] + fraction * straight_[p];
    }
    return;
  }
  fill(chain_at_fraction(fraction), there);
}

Pose PointMotion::flange_at(double fraction) noexcept {
  return chain_at_fraction(fraction).flange();
}

const ChainState& PointMotion::chain_at(int knot) noexcept {
  return knot == 0 ? start_ : chain_at_fraction(static_cast<double>(knot) / last_knot);
}

/// Returns the chain at a fraction of the motion. Computes it unless it is the last one computed.
const ChainState& PointMotion::chain_at_fraction(double fraction) noexcept {
  if (number_of_state_ == number_ && fraction_of_state_ == fraction) return state_;
  budget_->spend(work::kinematics);
  const auto n = static_cast<std::size_t>(instrument_->chain().size());
  JointVector q;
  for (std::size_t k = 0; k < n; ++k) q[k] = q_[k] + fraction * increment_[k];
  instrument_->chain().forward_kinematics({q.data(), n}, state_);
  number_of_state_ = number_;
  fraction_of_state_ = fraction;
  return state_;
}

void PointMotion::fill(const ChainState& state, Positions& positions) const noexcept {
  const std::span<const LinkPoint> points = instrument_->points();
  for (std::size_t p = 0; p < points.size(); ++p) {
    positions.points[p] = state.at(points[p].link, points[p].position);
  }
}

}  // namespace keepout
