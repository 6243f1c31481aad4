// SPDX-License-Identifier: BSD-3-Clause
#include "guide_watch.h"

#include <algorithm>
#include <cmath>

#include "certified_clearance.h"
#include "guide_kinematics.h"
#include "keepout/activation/tolerances.h"

namespace keepout {
void GuideWatch::open() noexcept {
  const ChainState& chain = memory_.trial_motion.chain_at_start();
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    const Guide& guide = memory_.guides[g].guide;
    const double excess = guide.region().excess(guided_point(guide, chain));
    const double tolerance = tolerance_of(guide, memory_.tolerance);
    double& certified = memory_.guides[g].certified;
    certified = certified_clearance(-excess, certified, -guide.band(), guide.band(), tolerance);
    // Allows the certified excess, or the present one if that is larger (a deficit). With a deficit
    // the motion must end a little farther in, so that rounding does not accumulate.
    const double due = -certified + plane_rounding * tolerance;
    allowed_[g] = std::max(due, excess);
    const bool owes = excess > due;
    at_end_[g] = owes ? excess - due_gain * tolerance : allowed_[g];
    owes_ = owes_ || owes;
    is_recovering_ = is_recovering_ || is_recovering(g);
    memory_.guide_states[g] = {.excess = excess};
  }
  memory_.budget.spend(memory_.guides.size() * work::guide);
}

bool GuideWatch::is_recovering(std::size_t g) const noexcept {
  return memory_.guides[g].certified < -memory_.guides[g].guide.band();
}

double GuideWatch::allowance(std::size_t g, double unused) const noexcept {
  return std::max(at_end_[g] - unused * memory_.guides[g].guide.band(), 0.0);
}

bool GuideWatch::may_leave_again(const Row& row, std::span<const double> increment) const noexcept {
  const Guide& guide = memory_.guides[guide_of(row.owner)].guide;
  const double bend = guided_bend(guide, memory_.trial_motion.chain_at_start(), increment, 0.0);
  return bend / 2.0 > row.bound + row.correction + guide.band();
}

GuideWatch::Obstacle GuideWatch::judge() noexcept {
  Obstacle obstacle;
  const JointVector& increment = memory_.trial_motion.increment();
  if (std::all_of(increment.begin(), increment.end(), [](double x) { return x == 0.0; })) {
    return obstacle;  // zero motion changes no excess
  }
  for (std::size_t g = 0; g < size() && obstacle.knot > 0; ++g) {
    if (is_dropped_[g]) continue;
    const Sample at_end = sample(g, PointMotion::last_knot);
    const bool gains_too_little = at_end_[g] < allowed_[g] && at_end.excess > at_end_[g];
    const int until =
        gains_too_little ? 0 : proved_until(g, 0, sample(g, 0), PointMotion::last_knot, at_end);
    if (until < obstacle.knot) obstacle = {until, g};
  }
  return obstacle;
}

GuideWatch::Sample GuideWatch::sample(std::size_t g, int knot) noexcept {
  const Guide& guide = memory_.guides[g].guide;
  const ChainState& chain = memory_.trial_motion.chain_at(knot);
  return {guide.region().excess(guided_point(guide, chain)), guided_fraction(guide, chain)};
}

/// Returns the last knot up to which the sub-interval from lo to hi is proved.
int GuideWatch::proved_until(std::size_t g, int lo, const Sample& at_lo, int hi,
                             const Sample& at_hi) noexcept {
  Budget& budget = memory_.budget;
  budget.spend(work::guide);
  if (budget.is_spent()) return lo;
  const Guide& guide = memory_.guides[g].guide;
  const double span = static_cast<double>(hi - lo) / PointMotion::last_knot;
  const double slide = std::abs(at_hi.fraction - at_lo.fraction) / span;
  const auto n = static_cast<std::size_t>(memory_.instrument.chain().size());
  const double bend = guided_bend(guide, memory_.trial_motion.chain_at_start(),
                                  {memory_.trial_motion.increment().data(), n}, slide);
  if (std::max(at_lo.excess, at_hi.excess) + bend * span * span / 8.0 <= allowed_[g]) return hi;
  if (hi - lo == 1) return lo;
  const int middle = (lo + hi) / 2;
  const Sample at_middle = sample(g, middle);
  const int first = proved_until(g, lo, at_lo, middle, at_middle);
  return first < middle ? first : proved_until(g, middle, at_middle, hi, at_hi);
}

std::optional<Row> GuideWatch::row(std::size_t g, int knot) noexcept {
  const Guide& guide = memory_.guides[g].guide;
  const Region& region = guide.region();
  const Vec3 outward = region.outward(guided_point(guide, memory_.trial_motion.chain_at(knot)));
  if (outward.isZero(0.0)) return std::nullopt;
  const ChainState& chain = memory_.trial_motion.chain_at_start();
  Row row{.owner = owner_of_guide(g), .triangle = no_triangle};
  row.normal = -outward;
  row.offset = row.normal.dot(region.origin()) - region.radius();
  row.start_height = row.normal.dot(guided_point(guide, chain)) - row.offset;
  // Guides return to their regions as fast as bodies retreat; orientation_weight converts
  // rotations.
  const double per_length =
      guide.is_angular() ? std::max(cycle_.options.orientation_weight, 1.0) : 1.0;
  row.bound = std::min(-row.start_height, cycle_.options.recovery / per_length);
  for (int k = 1; k <= chain.size(); ++k) {
    row.gradient[static_cast<std::size_t>(k - 1)] =
        row.normal.dot(guided_derivative(guide, chain, k));
  }
  return row;
}

double GuideWatch::height_at_end(const Row& row) noexcept {
  const Guide& guide = memory_.guides[guide_of(row.owner)].guide;
  return row.normal.dot(
             guided_point(guide, memory_.trial_motion.chain_at(PointMotion::last_knot))) -
         row.offset;
}

}  // namespace keepout
