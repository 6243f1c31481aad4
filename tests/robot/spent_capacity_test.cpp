// SPDX-License-Identifier: BSD-3-Clause
// The work budget or the memory of an instrument's cycle runs out at an arbitrary point.
#include <gtest/gtest.h>

#include <span>

#include "brute_force.h"
#include "guards.h"
#include "near_set.h"
#include "trials.h"

namespace keepout {
namespace {

/// An arm that turns twice beside a cube whose corners are at 50. The ball at its end swings across
/// the cube's top, and would come down on it.
struct Swing {
  explicit Swing(const InstrumentCapacity& capacity)
      : mesh(mesh_of(make_cube(50.0))),
        guard(guard_of(
            mesh,
            {Chain({{.axis = Vec3::UnitZ()}, {.origin = {Vec3(60, 0, 0)}, .axis = Vec3::UnitY()}},
                   {Vec3(-120, 0, 70)}),
             {{"shaft", {{1, Vec3::Zero()}, {2, Vec3::Zero()}}, 2.0},
              {"ball", {{2, Vec3(40, 0, 0)}}, 3.0}}},
            {.check_sides = false}, capacity)) {}

  /// Fails unless start + s dq is clear for s in [0, 1].
  void expect_clear(std::span<const double> dq, double share) const {
    const double kept = guard.options().margin - guard.options().band - 3.0 * guard.tolerance();
    constexpr int poses = 8;
    for (int s = 1; s <= poses; ++s) {
      std::vector<double> there = start;
      for (std::size_t k = 0; k < there.size(); ++k) there[k] += s * share / poses * dq[k];
      ASSERT_GE(clearance_of(guard.instrument(), *mesh, there), kept)
          << "at " << s << " of " << poses;
    }
  }

  /// Fails unless all certified parts of the motion are clear. Counts the motions with such a part.
  void expect_safe(int& counted) {
    const MotionProof proof = guard.prove(start, motion);
    expect_clear(motion, proof.share);
    const InstrumentStep step = guard.step(start, motion);
    ASSERT_TRUE(step.ok() || step.increment.empty()) << name(step.status);
    if (step.ok()) expect_clear(step.increment, 1.0);
    counted += proof.share > 0.0 && step.ok() ? 1 : 0;
  }

  const std::vector<double> start{-0.3, 0.1};
  const std::vector<double> motion{0.6, 0.45};
  std::shared_ptr<const Mesh> mesh;
  InstrumentConstraint guard;
};

TEST(SpentCapacity, NothingIsCertifiedThatIsNotClearWhereverTheWorkEnds) {
  Swing whole({});
  const MotionProof proof = whole.guard.prove(whole.start, whole.motion);
  ASSERT_GT(proof.share, 0.5);
  ASSERT_LT(proof.share, 1.0) << "the end is in the cube";
  std::size_t all = whole.guard.looks();
  ASSERT_TRUE(whole.guard.step(whole.start, whole.motion).ok());
  all = std::max(all, whole.guard.looks());
  ASSERT_GT(all, 50u);
  int certified = 0;
  const std::size_t stride = test::few_trials() ? 10 : 1;
  for (std::size_t looks = 1; looks <= all + 1; looks += stride) {
    SCOPED_TRACE(testing::Message() << "looks " << looks);
    Swing swing({.looks = looks});
    ASSERT_NO_FATAL_FAILURE(swing.expect_safe(certified));
  }
  EXPECT_GT(certified, test::trials(50));
}

TEST(SpentCapacity, NothingIsCertifiedThatIsNotClearHoweverFewTrianglesFit) {
  int certified = 0;
  for (std::size_t room = 1; room <= 64; ++room) {
    SCOPED_TRACE(testing::Message() << "room " << room);
    Swing swing({.triangles = room});
    ASSERT_NO_FATAL_FAILURE(swing.expect_safe(certified));
  }
  EXPECT_GT(certified, 10);
}

// A motion that is made as a whole was not shortened by the budget that ends its refinement.
TEST(SpentCapacity, IsNoLimitOfAMotionThatIsMadeAsAWhole) {
  int made_as_a_whole = 0;
  for (std::size_t looks = 800; looks < 1200; ++looks) {
    Swing swing({.looks = looks});
    swing.guard.set_options({.margin = 2.0, .band = 1.0, .check_sides = false});
    const InstrumentStep step = swing.guard.step(swing.start, swing.motion);
    if (step.status != Status::limited) continue;
    ++made_as_a_whole;
    EXPECT_EQ(step.share, 1.0) << looks;
    EXPECT_FALSE(step.limits.has(Limit::budget)) << looks;
  }
  EXPECT_GT(made_as_a_whole, 100);
}

// The index has room for all triangles, the set for fewer.
TEST(SpentCapacity, ANearSetThatCannotHoldAllTrianglesKnowsNothing) {
  const auto mesh = mesh_of(make_cube(50.0));
  Budget budget;
  Neighborhood near(mesh, std::make_shared<WideBvh>(mesh), mesh->triangle_count(), budget);
  const std::vector<Vec3> core{Vec3::Zero()};
  for (std::size_t room = 1; room <= mesh->triangle_count(); ++room) {
    NearSet set(room, 0.0);
    const bool holds_all = room == mesh->triangle_count();
    ASSERT_EQ(set.gather(near, core, 200.0, budget), holds_all) << room;
    ASSERT_EQ(set.radius() >= 0.0, holds_all) << room;
  }
}

}  // namespace
}  // namespace keepout
