// SPDX-License-Identifier: BSD-3-Clause
#include "guide_watch.h"

#include <algorithm>
#include <cmath>

#include "guide_kinematics.h"

namespace keepout {
namespace {

constexpr std::size_t work_of_guide = 2;  // in looks

}  // namespace

void GuideWatch::open() noexcept {
  const ChainState& chain = memory_.motion.chain_at_start();
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    const Guide& guide = memory_.guides[g].guide;
    const double excess = guide.region().excess(guided_point(guide, chain));
    const double tolerance = memory_.tolerance_of(guide);
    double& floor = memory_.guides[g].floor;
    floor = certified_distance(-excess, floor, -guide.band(), guide.band(), tolerance);
    // Like a body's: what is there if rounding has left less than what is certified; then a motion
    // has to gain something, so that rounding adds up to nothing.
    allowed_[g] = std::max(-floor + 2.0 * tolerance, excess);
    const bool owes = excess > -floor + 2.0 * tolerance;
    at_end_[g] = owes ? excess - tolerance / 8.0 : allowed_[g];
    owes_ = owes_ || owes;
    is_recovering_ = is_recovering_ || is_recovering(g);
    memory_.guide_states[g] = {.excess = excess};
  }
  memory_.budget.spend(work_of_guide * memory_.guides.size());
}

bool GuideWatch::is_recovering(std::size_t g) const noexcept {
  return memory_.guides[g].floor < -memory_.guides[g].guide.band();
}

double GuideWatch::allowance(std::size_t g, double unused) const noexcept {
  return std::max(at_end_[g] - unused * memory_.guides[g].guide.band(), 0.0);
}

bool GuideWatch::bends_by_more(const ContactRow& row,
                               std::span<const double> increment) const noexcept {
  const Guide& guide = memory_.guides[row.owner - most_pairs].guide;
  const double bend = guided_bend(guide, memory_.motion.chain_at_start(), increment, 0.0);
  return bend / 2.0 > row.bound + row.correction + guide.band();
}

int GuideWatch::judge(std::size_t& failed) noexcept {
  cell_of_chain_ = 0;
  int proven = PointMotion::cells;
  const JointVector& increment = memory_.motion.increment();
  if (std::all_of(increment.begin(), increment.end(), [](double x) { return x == 0.0; })) {
    return proven;  // guides do not move
  }
  for (std::size_t g = 0; g < memory_.guides.size() && proven > 0; ++g) {
    if (is_dropped_[g]) continue;
    const Standing at_end = standing(g, PointMotion::cells);
    const bool gains_too_little = at_end_[g] < allowed_[g] && at_end.excess > at_end_[g];
    const int until =
        gains_too_little ? 0 : proven_until(g, 0, standing(g, 0), PointMotion::cells, at_end);
    if (until >= proven) continue;
    proven = until;
    failed = g;
  }
  return proven;
}

GuideWatch::Standing GuideWatch::standing(std::size_t g, int cell) noexcept {
  const Guide& guide = memory_.guides[g].guide;
  const ChainState& chain = chain_at(cell);
  return {guide.region().excess(guided_point(guide, chain)), guided_fraction(guide, chain)};
}

/// The grid's last point up to which the part from lo to hi is proven.
int GuideWatch::proven_until(std::size_t g, int lo, const Standing& at_lo, int hi,
                             const Standing& at_hi) noexcept {
  Budget& budget = memory_.budget;
  budget.spend(work_of_guide);
  if (budget.is_spent()) return lo;
  const Guide& guide = memory_.guides[g].guide;
  const double part = static_cast<double>(hi - lo) / PointMotion::cells;
  const double slide = std::abs(at_hi.share - at_lo.share) / part;
  const auto n = static_cast<std::size_t>(memory_.instrument.chain().size());
  const double bend = guided_bend(guide, memory_.motion.chain_at_start(),
                                  {memory_.motion.increment().data(), n}, slide);
  if (std::max(at_lo.excess, at_hi.excess) + bend * part * part / 8.0 <= allowed_[g]) return hi;
  if (hi - lo == 1) return lo;
  const int middle = (lo + hi) / 2;
  const Standing at_middle = standing(g, middle);
  const int first = proven_until(g, lo, at_lo, middle, at_middle);
  return first < middle ? first : proven_until(g, middle, at_middle, hi, at_hi);
}

std::optional<ContactRow> GuideWatch::row(std::size_t g, int cell) noexcept {
  const Guide& guide = memory_.guides[g].guide;
  const Region& region = guide.region();
  const Vec3 outward = region.outward(guided_point(guide, chain_at(cell)));
  if (outward.isZero(0.0)) return std::nullopt;
  const ChainState& chain = memory_.motion.chain_at_start();
  ContactRow row{.owner = most_pairs + g, .triangle = no_triangle};
  row.normal = -outward;
  row.level = row.normal.dot(region.origin()) - region.radius();
  row.start_height = row.normal.dot(guided_point(guide, chain)) - row.level;
  // What is out is led back as fast as bodies are led off, turns by as much as moves a tool so.
  const double per_length = guide.is_angular() ? std::max(options_.orientation_weight, 1.0) : 1.0;
  row.bound = std::min(-row.start_height, options_.recovery / per_length);
  for (int k = 1; k <= chain.size(); ++k) {
    row.gradient[static_cast<std::size_t>(k - 1)] =
        row.normal.dot(guided_derivative(guide, chain, k));
  }
  return row;
}

double GuideWatch::height_at_end(const ContactRow& row) noexcept {
  const Guide& guide = memory_.guides[row.owner - most_pairs].guide;
  return row.normal.dot(guided_point(guide, chain_at(PointMotion::cells))) - row.level;
}

const ChainState& GuideWatch::chain_at(int cell) noexcept {
  if (cell == 0) return memory_.motion.chain_at_start();
  if (cell != cell_of_chain_) {
    memory_.budget.spend(work_of_guide);
    memory_.motion.place(cell, chain_);
    cell_of_chain_ = cell;
  }
  return chain_;
}

}  // namespace keepout
