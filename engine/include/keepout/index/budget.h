// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "keepout/index/work.h"
#include "keepout/status.h"

namespace keepout {

/// The work budget of a control cycle, in work units, for tips and instruments. Each kind of work
/// counts by its weight (work.h), so that a unit takes about the same time in each cycle. Counts
/// are the same on every processor, but depend on the caches that an index keeps between cycles
/// (TraversalCache). (Not counted: the nodes that TraversalCache::cover opens, at most 32 per call,
/// with at most two calls when a traversal begins.)
///
/// Each part of a cycle spends units before or after its work, and stops once all are spent. No
/// motion is accepted that could depend on triangles not examined.
class Budget {
 public:
  /// Effectively unlimited: for measurements and offline use.
  static constexpr std::size_t unlimited = std::numeric_limits<std::ptrdiff_t>::max() / 4;

  /// Makes a budget of `work_units` for each cycle, at most `unlimited`.
  explicit Budget(std::size_t work_units = unlimited) noexcept
      : all_(static_cast<std::int64_t>(work_units < unlimited ? work_units : unlimited)),
        left_(all_) {}

  /// Begins a new cycle, with all units.
  void renew() noexcept {
    left_ = all_;
    overflowed_ = false;
  }

  /// Spends work units.
  void spend(std::size_t work_units) noexcept { left_ -= static_cast<std::int64_t>(work_units); }

  /// Spends the units of a quadratic program. Each iteration visits all rows. The first one
  /// factorizes the Jacobian. `iterations` is also set if the solver failed.
  void spend_solve(std::size_t variables, std::size_t rows, int iterations) noexcept {
    const auto count = static_cast<std::size_t>(iterations > 0 ? iterations : 0);
    spend(work::solve);
    spend((variables * variables * variables / 64) * work::factor);
    spend(count * work::iteration);
    spend((count + 1) * (variables * rows / 48) * work::solved_rows);
  }

  /// Spends all units: no further examination is allowed.
  void spend_all() noexcept { left_ = 0; }

  /// Records that a buffer was too small.
  void mark_overflow() noexcept { overflowed_ = true; }

  /// Returns why the work failed: over_capacity if a buffer was too small, else out_of_budget.
  Status failure() const noexcept {
    return overflowed_ ? Status::over_capacity : Status::out_of_budget;
  }

  /// Returns true if no units are left.
  bool is_spent() const noexcept { return left_ <= 0; }

  /// Returns the work units spent in this cycle.
  std::size_t spent() const noexcept {
    return static_cast<std::size_t>(left_ > 0 ? all_ - left_ : all_);
  }

  /// Runs `attempt` with half of the remaining units, and clears an earlier overflow. Units that
  /// the attempt does not spend remain. Returns the result of the attempt.
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
