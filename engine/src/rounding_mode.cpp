// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/rounding_mode.h"

#include "keepout/error.h"

namespace keepout {

void require_rounding_to_nearest() {
  if (rounds_to_nearest()) return;
  throw Error(
      "the floating-point arithmetic of this thread does not round to nearest, and all proofs "
      "assume that it does; call std::fesetround(FE_TONEAREST) before you make meshes, indices and "
      "constraints");
}

void RoundingToNearest::change() noexcept {
  std::fegetenv(&before_);
  std::fesetenv(FE_DFL_ENV);
}

void RoundingToNearest::restore() noexcept { std::fesetenv(&before_); }

}  // namespace keepout
