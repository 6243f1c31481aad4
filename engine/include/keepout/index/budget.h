// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "keepout/status.h"

namespace keepout {

/// The work that a control cycle may do, counted in work units, so
/// that it is the same on every processor. It also depends on what the caches of an index remember
/// of earlier cycles (TraversalCache). A unit is about the time of an examination of sixteen boxes
/// or triangles in single precision, of one triangle in double, or of sixteen planes; the constants
/// work_of_* count what takes longer. (Not counted: the nodes that a traversal cache opens,
/// TraversalCache::cover, at most 32 each time, at most twice when a traversal begins.)
///
/// Each part spends its units, before or after the work, and stops once all are spent. Triangles
/// that were not examined are then unknown, so no motion is accepted that could depend on them.
class Budget {
 public:
  /// Effectively unlimited: for measurements, and without a control cycle.
  static constexpr std::size_t unlimited = std::numeric_limits<std::ptrdiff_t>::max() / 4;

  /// With so many work units in a cycle, at most `unlimited`.
  explicit Budget(std::size_t work_units = unlimited) noexcept
      : all_(static_cast<std::int64_t>(work_units < unlimited ? work_units : unlimited)),
        left_(all_) {}

  /// A new cycle begins.
  void renew() noexcept {
    left_ = all_;
    overflowed_ = false;
  }

  /// Takes so many work units away.
  void spend(std::size_t work_units) noexcept { left_ -= static_cast<std::int64_t>(work_units); }

  /// Spends all: nothing more may be examined.
  void spend_all() noexcept { left_ = 0; }

  /// Notes that a store was too small for what was found.
  void mark_overflow() noexcept { overflowed_ = true; }

  /// Returns why the work failed: over_capacity if a store was too small, else out_of_budget.
  Status failure() const noexcept {
    return overflowed_ ? Status::over_capacity : Status::out_of_budget;
  }

  /// Returns true if nothing is left.
  bool is_spent() const noexcept { return left_ <= 0; }

  /// Returns the work units spent in this cycle.
  std::size_t spent() const noexcept {
    return static_cast<std::size_t>(left_ > 0 ? all_ - left_ : all_);
  }

  /// Runs `attempt` with half of the units that are left, and forgets an earlier overflow.
  /// Afterwards the other half, and what the attempt has not spent, are left. Returns the result of
  /// the attempt.
  template <class Attempt>
  auto halved(const Attempt& attempt) noexcept(noexcept(attempt())) {
    const std::int64_t aside = left_ / 2;
    overflowed_ = false;
    left_ -= aside;
    auto result = attempt();
    left_ += aside;
    return result;
  }

 private:
  std::int64_t all_;
  std::int64_t left_;
  bool overflowed_ = false;
};

}  // namespace keepout
