// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "step/branches.h"
#include "trials.h"

namespace keepout {
namespace {

constexpr double margin = 0.1;

MotionConstraint guard(const std::shared_ptr<const Mesh>& mesh, int nodes) {
  return make_motion_constraint(mesh, {.options = {.radius = 6.0, .margin = margin, .nodes = nodes},
                                       .inside = Inside::taken_as_is});
}

std::vector<Motion> motions_near(const Mesh& mesh, std::size_t count) {
  Random random(4);
  std::vector<Motion> out;
  for (const Vec3& tip : surface_points(mesh, count, 0.4, random)) {
    out.push_back({.tip = tip, .desired = random.uniform(0.5, 5.0) * random.direction()});
  }
  return out;
}

class BranchAndBound : public testing::TestWithParam<const char*> {
 protected:
  std::shared_ptr<const Mesh> mesh_ = mesh_of(GetParam());
};

TEST_P(BranchAndBound, IsSafeAndNeverWorseThanTheStepWithoutIt) {
  auto plain = guard(mesh_, 0);
  auto searching = guard(mesh_, 16);
  oracle::SafetyOracle oracle(mesh_);
  std::size_t better = 0;
  for (const Motion& motion : motions_near(*mesh_, 400)) {
    const Step without = plain.step(motion);
    if (without.status != Status::limited) continue;
    const double cost = (without.motion - motion.desired).norm();
    const Step with = searching.step(motion);
    ASSERT_EQ(with.status, Status::limited);
    const double gain = cost - (with.motion - motion.desired).norm();
    ASSERT_GE(gain, 0.0);
    better += gain > 0.01 * motion.desired.norm();
    const double kept = std::min(margin, oracle.distance(motion.tip));
    ASSERT_FALSE(oracle.check(motion.tip, motion.tip + with.motion, kept - 1e-8).below);
  }
  EXPECT_GT(better, 0u) << "nothing to search for";
}

TEST_P(BranchAndBound, DoesNotDependOnTheNumbering) {
  Surface reversed = make_shape(GetParam());
  std::reverse(reversed.triangles.begin(), reversed.triangles.end());
  for (Corners& corners : reversed.triangles) std::swap(corners[0], corners[1]);
  auto one = guard(mesh_, 16);
  auto other = guard(mesh_of(reversed), 16);
  for (const Motion& motion : motions_near(*mesh_, 200)) {
    const Step a = one.step(motion);
    const Step b = other.step(motion);
    ASSERT_EQ(a.status, b.status);
    ASSERT_EQ(a.motion, b.motion);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, BranchAndBound,
                         testing::Values("cube", "gear", "cortex", "triangle_soup", "crown"),
                         by_name);

TEST(Branches, TheNearestOpenOneComesFirstAndOnce) {
  Branches branches(3);
  const std::vector<HalfSpace> planes{{Vec3::UnitX(), -1.0, 7}};
  branches.push(2.0, Vec3::UnitX(), planes);
  branches.push(1.0, Vec3::UnitY(), planes);
  branches.push(1.0, Vec3::UnitZ(), {});
  branches.push(0.5, Vec3::Zero(), planes);  // exceeds the capacity
  const Branch* first = branches.pop_nearest();
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->motion, Vec3::UnitY()) << "of equals the first";
  ASSERT_EQ(first->planes().size(), 1u);
  EXPECT_EQ(first->planes()[0].source, 7u);
  EXPECT_EQ(branches.pop_nearest()->motion, Vec3::UnitZ());
  EXPECT_EQ(branches.pop_nearest()->motion, Vec3::UnitX());
  EXPECT_EQ(branches.pop_nearest(), nullptr);
  branches.clear();
  EXPECT_EQ(branches.pop_nearest(), nullptr);
}

TEST(Branches, MorePlanesThanABranchHoldsAreNoBranch) {
  Branches branches(1);
  const std::vector<HalfSpace> planes(Branch::most_planes + 1, {Vec3::UnitX(), -1.0, 7});
  branches.push(1.0, Vec3::UnitX(), planes);
  EXPECT_EQ(branches.pop_nearest(), nullptr);
}

}  // namespace
}  // namespace keepout
