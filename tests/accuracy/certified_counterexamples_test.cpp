// SPDX-License-Identifier: BSD-3-Clause
// The certified rule is safe where the rule of Li et al. (2020) fails, with any order and winding
// of the triangles.

#include "accuracy/certified_loop.h"
#include "accuracy/segment_crossing.h"
#include "keepout/fixtures/counterexamples.h"

namespace keepout::test::certified_counterexamples {
namespace {

constexpr std::string_view on_the_mesh = "CE4_on_a_ridge";

MotionConstraintSettings settings_of(const Counterexample& example, double margin) {
  return {.options = {.radius = example.radius, .margin = margin}, .capacity = {.planes = 100}};
}

/// Returns the steps of a loop that repeats one desired motion.
std::vector<Cycle> cycles(const Surface& surface, const Counterexample& example, double margin) {
  auto guard = make_motion_constraint(mesh_of(surface), settings_of(example, margin));
  std::vector<Cycle> out;
  Vec3 tip = example.tip;
  for (int cycle = 0; cycle < 12; ++cycle) {
    const Step step = guard.step({.tip = tip, .desired = example.desired});
    out.push_back({step.status, step.motion});
    tip += step.motion;
  }
  return out;
}

class CertifiedCounterexample : public testing::TestWithParam<Counterexample> {};

constexpr double margins[] = {1e-5, 1e-3, 0.02, 0.2};

TEST_P(CertifiedCounterexample, KeepsItsDistanceOnTheWholeWay) {
  const Counterexample& example = GetParam();
  for (const double margin : margins) {
    Loop loop(example.surface, settings_of(example, margin));
    Vec3 tip = example.tip;
    for (int cycle = 0; cycle < 12; ++cycle) {
      const Step step = loop.step(tip, example.desired);
      if (loop.distance(tip) == 0.0) {
        ASSERT_EQ(step.status, Status::touching);
        ASSERT_EQ(step.motion, Vec3::Zero());
        break;
      }
      ASSERT_TRUE(step.ok()) << step.reason();
      ASSERT_NE(step.status, Status::truncated) << "margin " << margin << ", cycle " << cycle;
      ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0)
          << "margin " << margin << ", cycle " << cycle;
      ASSERT_FALSE(passes_through(loop.mesh(), tip, tip + step.motion));
      tip += step.motion;
    }
  }
}

TEST_P(CertifiedCounterexample, IsTheSameWithAllWindings) {
  const Counterexample& example = GetParam();
  const std::size_t count = example.surface.triangles.size();
  ASSERT_LE(count, 8u);
  for (const double margin : margins) {
    const std::vector<Cycle> expected = cycles(example.surface, example, margin);
    for (unsigned flips = 1; flips < 1u << count; ++flips) {
      // A closed mesh with all triangles flipped is another mesh: its free side is the inside.
      if (example.name == "CE5_closed_octahedron" && flips + 1 == 1u << count) continue;
      Surface surface = example.surface;
      for (std::size_t t = 0; t < count; ++t) {
        if ((flips >> t & 1u) != 0) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
      }
      ASSERT_EQ(cycles(surface, example, margin), expected) << "flips " << flips;
    }
  }
}

TEST_P(CertifiedCounterexample, IsTheSameWithAnyNumbering) {
  const Counterexample& example = GetParam();
  Random random(1);
  for (const double margin : margins) {
    const std::vector<Cycle> expected = cycles(example.surface, example, margin);
    for (int i = 0; i < test::trials(100); ++i) {
      Surface other = renumbered(example.surface, random);
      ASSERT_EQ(cycles(other, example, margin), expected) << "numbering " << i;
      if (example.name == "CE5_closed_octahedron") continue;
      other = rewound(std::move(other), random);
      ASSERT_EQ(cycles(other, example, margin), expected) << "numbering and winding " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CE, CertifiedCounterexample, testing::ValuesIn(counterexamples()),
                         by_name);

TEST(CertifiedCounterexamples, WhatIsFreeComesBackUnchanged) {
  for (const Counterexample& example : counterexamples()) {
    if (example.name != "CE6c_larger_saddle" && example.name != "CE7_lock_up") continue;
    Loop loop(example.surface, settings_of(example, 1e-5));
    const Step step = loop.step(example.tip, example.desired);
    EXPECT_EQ(step.status, Status::free) << example.name;
    EXPECT_EQ(step.motion, example.desired) << example.name;
  }
}

TEST(CertifiedCounterexamples, TheTipOfTheClosedOneIsOutside) {
  for (const Counterexample& example : counterexamples()) {
    if (example.name != "CE5_closed_octahedron") continue;
    Loop loop(example.surface, settings_of(example, 0.02));
    EXPECT_EQ(loop.oracle().inside(example.tip), false);
    EXPECT_EQ(loop.step(example.tip, example.desired).status, Status::limited);
  }
}

TEST(CertifiedCounterexamples, OnlyOneTipIsOnItsMesh) {
  for (const Counterexample& example : counterexamples()) {
    const Loop loop(example.surface, settings_of(example, 0.02));
    EXPECT_EQ(loop.distance(example.tip) == 0.0, example.name == on_the_mesh) << example.name;
  }
}

}  // namespace
}  // namespace keepout::test::certified_counterexamples
