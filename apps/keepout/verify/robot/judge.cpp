// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {
namespace {

constexpr int poses_of_a_cycle = 6;

/// Whether a joint may go there, but for what sums are rounded: one that is outside of its limits
/// may stay, or come back.
bool is_allowed(const Joint& joint, double from, double to, double period) {
  const JointLimits& limits = joint.limits;
  const double rounding = 1e-14 * (std::abs(from) + std::abs(to));
  return to >= std::min(limits.lower, from) - rounding &&
         to <= std::max(limits.upper, from) + rounding &&
         std::abs(to - from) <= std::min(limits.increment, limits.velocity * period) + rounding;
}

}  // namespace

RobotJudge::RobotJudge(oracle::InstrumentOracle& oracle, const Chain& chain, Random& random,
                       std::span<const double> positions, const InstrumentOptions& options,
                       double tolerance)
    : oracle_(&oracle),
      chain_(&chain),
      random_(&random),
      positions_(positions.begin(), positions.end()),
      options_(options),
      tolerance_(tolerance),
      clearances_(oracle.bodies()),
      floors_(oracle.bodies(), -std::numeric_limits<double>::infinity()) {
  look(positions_, clearances_);
}

void RobotJudge::follow(const InstrumentOptions& options) {
  options_ = options;
  look(positions_, clearances_);
}

bool RobotJudge::is_recovered() const noexcept {
  return std::ranges::min(clearances_) >= options_.margin - options_.band - 3.0 * tolerance_;
}

void RobotJudge::look(std::span<const double> positions, std::span<double> clearances) {
  oracle_->move_to(positions);
  for (std::size_t b = 0; b < clearances.size(); ++b) {
    clearances[b] = oracle_->clearance(b, options_.margin);
  }
}

RobotVerdict RobotJudge::judge(std::span<const double> next) {
  const std::vector<double> from = positions_;
  least_ = clearances_;
  RobotVerdict verdict{};
  for (std::size_t b = 0; b < least_.size(); ++b) {
    floors_[b] = std::min(std::max(floors_[b], clearances_[b] - options_.band),
                          options_.margin - options_.band);
  }
  for (std::size_t k = 0; k < from.size(); ++k) {
    verdict.limits_broken =
        verdict.limits_broken ||
        !is_allowed(chain_->joint(static_cast<int>(k) + 1), from[k], next[k], options_.period);
  }
  for (int i = 1; i < poses_of_a_cycle && !std::ranges::equal(next, from); ++i) {
    // One at the end, and one at random in each quarter.
    const double s =
        i == poses_of_a_cycle - 1 ? 1.0 : (i - random_->uniform()) / (poses_of_a_cycle - 2);
    for (std::size_t k = 0; k < from.size(); ++k) {
      positions_[k] = s == 1.0 ? next[k] : from[k] + s * (next[k] - from[k]);
    }
    look(positions_, clearances_);
    std::ranges::transform(least_, clearances_, least_.begin(),
                           [](double a, double b) { return std::min(a, b); });
  }
  verdict.least = std::ranges::min(least_);
  verdict.beyond = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < least_.size(); ++b) {
    verdict.beyond = std::min(verdict.beyond, least_[b] - floors_[b]);
  }
  verdict.is_below = !(verdict.beyond >= -3.0 * tolerance_);
  return verdict;
}

}  // namespace keepout::app
