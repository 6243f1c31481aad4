// SPDX-License-Identifier: BSD-3-Clause
#include "certified_clearance.h"

#include <gtest/gtest.h>

#include <limits>

namespace keepout {
namespace {

constexpr double wanted_distance = 0.198;
constexpr double left_to_a_motion = 0.002;
constexpr double told_apart = 1e-9;

double certified_at(double distance, double floor) {
  return certified_clearance(distance, floor, wanted_distance, left_to_a_motion, told_apart);
}

// Bodies and guides alike: what is certified is what was gained, and no band of it is given away.
TEST(CertifiedClearance, IsTheTargetWhereThatIsKeptHoweverLittleWasCertifiedBefore) {
  for (const double floor :
       {-1.0, 0.0, 0.1, wanted_distance, std::numeric_limits<double>::infinity()}) {
    for (const double beyond : {0.0, 0.001, 0.5, -2.7 * told_apart}) {
      EXPECT_EQ(certified_at(wanted_distance + beyond, floor), wanted_distance)
          << floor << ' ' << beyond;
    }
  }
}

TEST(CertifiedClearance, BelowTheTargetLosesNothingThatWasCertified) {
  EXPECT_EQ(certified_at(0.15, 0.149), 0.149);
  EXPECT_EQ(certified_at(0.15, 0.1), 0.15 - left_to_a_motion)
      << "and gains what was recovered, less the room";
  EXPECT_EQ(certified_at(0.15, 0.15 + 3.5 * told_apart), 0.15 + 3.5 * told_apart)
      << "rounding lowers nothing";
  EXPECT_EQ(certified_at(0.15, 0.19), 0.15 - left_to_a_motion) << "moved by somebody else";
}

// Theorem 2 needs both: a recovery that is accepted ends within 2.75 tolerances of the target, and
// a start that no cycle has certified is certified to what it has.
TEST(CertifiedClearance, IsLessThanTheTargetBeyond2_75TolerancesBelowItUnlessItWasCertified) {
  const double unknown = -std::numeric_limits<double>::infinity();
  for (const double below : {2.8, 2.9, 3.5, 3.9}) {
    const double distance = wanted_distance - below * told_apart;
    EXPECT_EQ(certified_at(distance, unknown), distance - left_to_a_motion) << below;
    EXPECT_EQ(certified_at(distance, 0.1), distance - left_to_a_motion) << below;
    EXPECT_EQ(certified_at(distance, wanted_distance), wanted_distance) << below;
  }
}

}  // namespace
}  // namespace keepout
