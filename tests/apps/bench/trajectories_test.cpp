// SPDX-License-Identifier: BSD-3-Clause
// The motions on which bench --speed is measured are what they claim to be.

#include "bench/speed/guarded_mesh.h"
#include "keepout/index/query.h"
#include "meshes.h"
#include "messages.h"

namespace keepout::app {
namespace {

IndexedMesh star() { return with_index(mesh_of(make_star_bumps(2.0))); }

TEST(Trajectories, APressedToolIsHeldBackInEveryCycle) {
  const IndexedMesh on = star();
  const MotionKind kind{.clearance = 0.5, .shortest = 0.1, .longest = 0.3};
  const std::vector<Motion> motions = pressed_motions(on, 400, kind, Random(1));
  ASSERT_EQ(motions.size(), 400u);
  MotionConstraint guard = certified(queried(on), kind.clearance);
  NearestTriangle nearest(*on.mesh, *on.index);
  for (const Motion& motion : motions) {
    EXPECT_EQ(guard.step(motion).status, Status::limited);
    EXPECT_GE(motion.desired.norm(), kind.shortest * (1.0 - 1e-12));
    EXPECT_LE(motion.desired.norm(), kind.longest);
    EXPECT_GE(nearest(motion.tip).closest.distance, kind.clearance * (1.0 - 1e-6));
  }
}

TEST(Trajectories, AFreeToolIsNeverHeldBackAndStaysOnItsPath) {
  const IndexedMesh on = star();
  const FreeSpace space{.nearest = 2.0, .farthest = 20.0};
  const std::vector<Motion> motions = free_motions(on, 5000, space, {.clearance = 0.2}, Random(2));
  ASSERT_EQ(motions.size(), 5000u);
  MotionConstraint guard = certified(queried(on), 0.2);
  NearestTriangle nearest(*on.mesh, *on.index);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    EXPECT_EQ(guard.step(motions[i]).status, Status::free);
    const double distance = nearest(motions[i].tip).closest.distance;
    EXPECT_GE(distance, space.nearest);
    EXPECT_LE(distance, space.farthest);
    if (i == 0) continue;
    EXPECT_EQ(motions[i].tip, motions[i - 1].tip + motions[i - 1].desired);
  }
}

TEST(Trajectories, OfAPlannerAreHeldBackEachTime) {
  const IndexedMesh on = star();
  const std::vector<Motion> motions = held_back_motions(on, 300, {}, Random(4));
  ASSERT_EQ(motions.size(), 300u);
  MotionConstraint guard = certified(queried(on), MotionKind{}.clearance);
  for (const Motion& motion : motions) EXPECT_EQ(guard.step(motion).status, Status::limited);
}

TEST(Disagreement, IsToldOfAnyBitOfAStepAndOfNothingElse) {
  const IndexedMesh on = star();
  const std::vector<Motion> motions = pressed_motions(on, 400, {.clearance = 0.5}, Random(5));
  MotionConstraint ours = certified(on, 0.5), plain = certified(queried(on), 0.5);
  EXPECT_EQ(disagreement(ours, plain, motions), "");
  MotionConstraint other = certified(on, 0.5 * (1.0 + 1e-15));
  EXPECT_CONTAINS(disagreement(ours, other, motions), "not timed: ");
  EXPECT_EQ(disagreement(ours, other, motions, 1e-9), "");
}

TEST(Trajectories, SayWhereThereIsNoSuchSpace) {
  // Nowhere within a sphere of radius 50 is as far from it.
  const IndexedMesh on = with_index(mesh_of(make_concave_sphere(10.0)));
  EXPECT_THROW(free_motions(on, 10, {.nearest = 60.0, .farthest = 70.0}, {}, Random(3)), Error);
}

}  // namespace
}  // namespace keepout::app
