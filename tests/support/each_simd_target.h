// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "keepout/simd_target.h"
#include "trials.h"

namespace keepout {

/// Calls with everything running on each SIMD target that there is, the fastest first and the
/// portable one last; on these two alone where few trials are enough. Which those are is for
/// SimdTarget to say (engine/simd_target_test.cpp).
template <class Call>
void on_each_simd_target(Call&& call) {
  struct Restored {
    ~Restored() { use_simd_target(simd_targets().front()); }
  } restored;
  for (const std::string_view target : simd_targets()) {
    const bool is_between = target != simd_targets().front() && target != simd_targets().back();
    if (is_between && test::few_trials()) continue;
    SCOPED_TRACE(std::string(target));
    use_simd_target(target);
    call();
  }
}

}  // namespace keepout
