// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/simd_target.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>

#include "keepout/error.h"

namespace keepout {
namespace {

TEST(SimdTarget, IsTheFastestUnlessAnotherIsChosen) {
  EXPECT_EQ(simd_target(), simd_targets().front());
}

TEST(SimdTarget, IsTheOneThatWasChosenAndHidesNoOther) {
  const auto all = simd_targets();
  for (const std::string_view target : all) {
    use_simd_target(target);
    EXPECT_EQ(simd_target(), target);
    EXPECT_EQ(simd_targets(), all);
    EXPECT_EQ(simd_target(), target) << "to ask changes nothing";
  }
  use_simd_target(all.front());
}

TEST(SimdTarget, ThatIsNotThereIsRefusedAndLeavesWhatWasChosen) {
  const std::string_view last = simd_targets().back();
  use_simd_target(last);
  EXPECT_THROW(use_simd_target("abacus"), Error);
  EXPECT_EQ(simd_target(), last);
  use_simd_target(simd_targets().front());
}

/// on_each_simd_target (trials.h) uses this list.
TEST(SimdTarget, ThePortableOneIsAlwaysThere) {
  EXPECT_EQ(simd_targets().back(), hwy::TargetName(HWY_STATIC_TARGET));
}

TEST(SimdTarget, Avx2IsThereSoThatTheTestsOfEachTargetRunOnIt) {
  const auto all = simd_targets();
  if (std::ranges::find(all, "AVX2") == all.end()) {
    GTEST_SKIP() << "this processor has no AVX2: nothing was tested on it";
  }
  use_simd_target("AVX2");
  EXPECT_EQ(simd_target(), "AVX2");
  use_simd_target(all.front());
}

}  // namespace
}  // namespace keepout
