// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "keepout/status.h"

namespace keepout {

/// The work that a control cycle may do, whatever happens in it: counted in looks, so that it is
/// the same on every run and every processor. A look is one at sixteen boxes or triangles in single
/// precision, at one triangle in double, or at sixteen planes.
///
/// Whoever works spends, before or after, and stops once all is spent. What was not looked at then
/// is not known, so no motion is accepted that could depend on it.
class Budget {
 public:
  /// As much as nobody spends: for measuring, and where there is no control cycle.
  static constexpr std::size_t unlimited = std::numeric_limits<std::ptrdiff_t>::max() / 4;

  /// For so many looks in a cycle, at most `unlimited`.
  explicit Budget(std::size_t looks = unlimited) noexcept
      : all_(static_cast<std::int64_t>(looks < unlimited ? looks : unlimited)), left_(all_) {}

  /// A new cycle begins.
  void renew() noexcept {
    left_ = all_;
    overflowed_ = false;
  }

  /// Takes so many looks away.
  void spend(std::size_t looks) noexcept { left_ -= static_cast<std::int64_t>(looks); }

  /// Spends all: nothing more may be looked at.
  void spend_all() noexcept { left_ = 0; }

  /// Notes that a store was too small for what was found.
  void mark_overflow() noexcept { overflowed_ = true; }

  /// Returns why the work ended: over_capacity if a store was too small, else out_of_budget.
  Status status_at_end() const noexcept {
    return overflowed_ ? Status::over_capacity : Status::out_of_budget;
  }

  /// Whether nothing is left.
  bool is_spent() const noexcept { return left_ <= 0; }

  /// How many looks a cycle may take.
  std::size_t all() const noexcept { return static_cast<std::size_t>(all_); }

  /// How many looks were taken in this cycle.
  std::size_t spent() const noexcept {
    return static_cast<std::size_t>(left_ > 0 ? all_ - left_ : all_);
  }

  /// Leaves half of what is left to `attempt`, and what that leaves with the other half to those
  /// that come after it. Returns what the attempt does.
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
