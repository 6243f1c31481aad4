// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "oracle/hostile_pairs.h"
#include "oracle/infinity.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

double size_of(const HostilePair& pair) {
  double size = (pair.segment.to - pair.segment.from).lpNorm<1>();
  for (const Vec3& corner : pair.triangle) {
    size = std::max(size, (corner - pair.segment.from).lpNorm<1>());
  }
  return size;
}

TEST(BracketDistance, HoldsTheExactDistanceOfHostilePairs) {
  Random random(20261120);
  for (int i = 0; i < test::trials(30'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    ASSERT_LE(bracket.low, bracket.estimate);
    ASSERT_LE(bracket.estimate, bracket.high);
    ASSERT_TRUE(exact_distance(pair.segment, pair.triangle, bracket.low).against_threshold >= 0)
        << "pair " << i;
    ASSERT_TRUE(exact_distance(pair.segment, pair.triangle, bracket.high).against_threshold <= 0)
        << "pair " << i;
  }
}

TEST(NarrowDistance, IsWithinABillionthOfTheExactOneAndZeroOnlyAtATouch) {
  Random random(2);
  for (int i = 0; i < test::trials(40'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const Bracket narrow = narrow_distance(pair.segment, pair.triangle);
    const ExactDistance exact = exact_distance(pair.segment, pair.triangle, 0.0);
    ASSERT_TRUE(narrow.narrow());
    ASSERT_NEAR(narrow.estimate, exact.distance, 1e-9 * exact.distance) << "pair " << i;
    ASSERT_EQ(narrow.estimate == 0.0, exact.against_zero == 0) << "pair " << i;
    ASSERT_EQ(narrow.low == 0.0, exact.against_zero == 0) << "pair " << i;
  }
}

TEST(BracketDistance, IsNarrowForNearlyAllFairPairs) {
  Random random(3);
  const auto point = [&random]() -> Vec3 { return 10.0 * random.direction() * random.uniform(); };
  int wide = 0;
  const int count = test::trials(1'000'000);
  for (int i = 0; i < count; ++i) {
    HostilePair pair;
    pair.triangle = {point(), point(), point()};
    pair.segment.from = point();
    pair.segment.to = pair.segment.from + 0.2 * random.direction();
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    if (bracket.high < 1e-6) continue;
    if (bracket.high - bracket.low > 0x1p-46 * size_of(pair)) ++wide;
  }
  EXPECT_LT(wide, count / 1000);
}

TEST(BracketDistance, OfPairsBeyondItsRangeIsLeftOpen) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double unit : {1e-200, 1e200}) {
    const Triangle scaled{unit * triangle[0], unit * triangle[1], unit * triangle[2]};
    const Segment segment{unit * Vec3(0.25, 0.25, 1), unit * Vec3(0.25, 0.25, 2)};
    const Bracket bracket = bracket_distance(segment, scaled);
    EXPECT_EQ(bracket.low, 0.0);
    EXPECT_EQ(bracket.high, infinity);
    EXPECT_DOUBLE_EQ(exact_distance(segment, scaled, 0.0).distance, unit);
  }
}

/// What the whole oracle says of a mesh of one triangle, against the exact verdict.
void expect_exact_verdict(const HostilePair& pair, double threshold, SafetyOracle& oracle) {
  const Finding finding = oracle.check(pair.segment.from, pair.segment.to, threshold);
  const ExactDistance exact = exact_distance(pair.segment, pair.triangle, threshold);
  ASSERT_EQ(finding.crosses, exact.against_zero == 0) << threshold;
  ASSERT_EQ(finding.below, exact.against_threshold < 0) << threshold;
  ASSERT_EQ(finding.crosses, finding.distance == 0.0);
  if (finding.below) {
    ASSERT_LE(finding.distance, threshold);
  } else {
    ASSERT_GE(finding.distance, threshold);
  }
}

TEST(BracketDistance, AndTheExactOneNeverDisagreeOneStepAroundTheTruth) {
  Random random(4);
  for (int i = 0; i < test::trials(8'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const auto& [a, b, c] = pair.triangle;
    SafetyOracle oracle(mesh_of(Surface{{a, b, c}, {{0, 1, 2}}}));
    const double truth = exact_distance(pair.segment, pair.triangle, 0.0).distance;
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    for (const double threshold :
         {0.0, truth, std::nextafter(truth, 0.0), std::nextafter(truth, infinity), bracket.low,
          std::nextafter(bracket.high, infinity), truth * random.uniform(0.0, 2.0)}) {
      expect_exact_verdict(pair, threshold, oracle);
      if (HasFatalFailure()) FAIL() << "pair " << i;
    }
  }
}

}  // namespace
}  // namespace keepout::oracle
