// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cfenv>

namespace keepout {

/// Returns true if the arithmetic of this thread rounds to nearest, as all proofs assume. Takes
/// about 2 ns. Computes instead of asking the C library: std::fegetround() does not notice that the
/// mode of the SSE unit alone was changed.
inline bool rounds_to_nearest() noexcept {
  const volatile double one = 1.0;
  const double computed = one;
  return computed + 0x1p-60 == 1.0 && computed - 0x1p-60 == 1.0;
}

/// Throws Error if the arithmetic of this thread does not round to nearest. For code that makes
/// what later proofs rest on.
void require_rounding_to_nearest();

/// Lets the arithmetic of this thread round to nearest as long as the object lives. If it did not
/// before, the object replaces the floating-point environment by the default one, and restores it
/// at the end. For one thread, in one scope. Does not allocate or throw.
class RoundingToNearest {
 public:
  RoundingToNearest() noexcept : is_changed_(!rounds_to_nearest()) {
    if (is_changed_) change();
  }
  ~RoundingToNearest() {
    if (is_changed_) restore();
  }
  RoundingToNearest(const RoundingToNearest&) = delete;
  RoundingToNearest& operator=(const RoundingToNearest&) = delete;

 private:
  void change() noexcept;
  void restore() noexcept;

  bool is_changed_;
  std::fenv_t before_;
};

}  // namespace keepout
