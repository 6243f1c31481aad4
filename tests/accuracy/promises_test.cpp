// SPDX-License-Identifier: BSD-3-Clause
// Promises of docs/safety.md beside the certified step itself. Each of them was broken once.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <Eigen/Geometry>
#include <type_traits>

#include "accuracy/certified_loop.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree_1997.h"
#include "keepout/index/wide_bvh.h"
#include "messages.h"

namespace keepout::test::promises {
namespace {

// Every length outside the supported range is rejected.

TEST(Range, LengthsOutsideAreRefusedWithAWordOnThem) {
  for (const double unit : {1e-80, 1e-29, 1e-17, 1e17, 1e19, 1e25}) {
    SCOPED_TRACE(unit);
    const auto mesh = mesh_of(enlarged(make_cube(5.0), unit));
    EXPECT_THROW(
        make_motion_constraint(mesh, {.options = {.radius = 5.0 * unit, .margin = 0.2 * unit}}),
        Error);
  }
  const auto mesh = mesh_of(make_cube(5.0));
  EXPECT_THROW(make_motion_constraint(mesh, {.options = {.radius = 1e16}}), Error);
  EXPECT_THROW(make_motion_constraint(mesh, {.options = {.radius = 1e-16, .margin = 1e-6}}), Error);
  EXPECT_THROW(make_motion_constraint(mesh, {.options = {.tool_radius = 1e16}}), Error);
  EXPECT_THROW(make_motion_constraint(mesh, {.activation = "paper", .options = {.margin = 1e-16}}),
               Error);
  auto guard = make_motion_constraint(mesh, {.options = {.radius = 5.0, .margin = 0.2}});
  const Step far = guard.step({.tip = Vec3(2e15, 0.0, 0.0), .desired = Vec3(1.0, 0.0, 0.0)});
  EXPECT_EQ(far.status, Status::invalid_input);
}

class RangeWithin : public testing::TestWithParam<double> {};

TEST_P(RangeWithin, StepsAreCertifiedInWhateverUnit) {
  const double unit = GetParam();
  Random random(7);
  for (const char* shape : {"gear", "sphere", "needles"}) {
    SCOPED_TRACE(shape);
    Loop loop(enlarged(make_shape(shape), unit),
              {.options = {.radius = 2.0 * unit, .margin = 0.2 * unit}});
    std::size_t held = 0;
    for (const Vec3& place : places(loop, 40, 0.5 * unit, random)) {
      Vec3 tip = place;
      for (int cycle = 0; cycle < 5; ++cycle) {
        const Vec3 desired = 2.0 * unit * random.direction() * random.uniform();
        const Step step = loop.step(tip, desired);
        ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0);
        held += step.status == Status::limited;
        tip += step.motion;
      }
    }
    EXPECT_GT(held, 10u);
  }
}

INSTANTIATE_TEST_SUITE_P(Units, RangeWithin, testing::Values(1e-13, 1e-9, 1e-3, 1e3, 1e9, 1e12));

#if defined(__SSE2__)
/// The processor treats denormal numbers as 0, as audio and control loops often configure it.
TEST(RangeWithin, StepsAreTheSameWithoutDenormals) {
  for (const double unit : {1e-13, 1.0}) {
    const MotionConstraintSettings settings{
        .options = {.radius = 2.0 * unit, .margin = 0.2 * unit}};
    Loop loop(enlarged(make_shape("gear"), unit), settings);
    Random random(8);
    std::size_t held = 0;
    for (const Vec3& tip : places(loop, 200, 0.3 * unit, random)) {
      const Vec3 desired = 2.0 * unit * random.uniform() * random.direction();
      const Step expected = loop.step(tip, desired);
      const Vec3 motion = expected.motion;
      held += expected.status == Status::limited;
      const unsigned mode = _mm_getcsr();
      _mm_setcsr(mode | 0x8040);  // flush to zero, denormals are zero
      const Step step = loop.step(tip, desired);
      _mm_setcsr(mode);
      ASSERT_EQ(step.status, expected.status);
      ASSERT_EQ(step.motion, motion);
    }
    EXPECT_GT(held, 50u);
  }
}
#endif

// A guard returns no motion after its index has been refit to another mesh.

class AfterRefit : public testing::TestWithParam<const char*> {};

TEST_P(AfterRefit, NoStepMovesAndNoPolytopeIsFound) {
  const Surface cube = make_cube(5.0);
  const auto mesh = mesh_of(cube);
  auto tree = std::make_shared<WideBvh>(mesh);
  const bool is_certified = std::string_view(GetParam()) == "certified";
  auto guard = make_motion_constraint(
      mesh, tree,
      {.activation = GetParam(), .options = {.radius = 5.0, .margin = is_certified ? 0.2 : 0.0}});
  const double top = mesh->bounds().high.z();
  const Vec3 down(0.0, 0.0, -1.0);
  for (const double off : {2.0, 0.5, 0.1, -0.5}) {
    static_cast<void>(guard.step({.tip = Vec3(0.3, 0.2, top + off), .desired = down}));
  }
  tree->refit(mesh_of(moved(cube, Vec3(0.0, 0.0, 3.0))));
  for (const double off : {-1.0, 0.1, 0.5, 2.0, 2.9, 3.0, 3.1, 3.5, 5.0, 8.0, 40.0}) {
    SCOPED_TRACE(off);
    const Vec3 tip(0.3, 0.2, top + off);
    for (const Vec3& desired : {down, Vec3(-down)}) {
      const Step step = guard.step({.tip = tip, .desired = desired});
      EXPECT_FALSE(step.ok()) << name(step.status);
      EXPECT_EQ(step.motion, Vec3::Zero());
    }
    EXPECT_FALSE(guard.free_polytope(tip, 2.0).ok());
  }
}

INSTANTIATE_TEST_SUITE_P(Rules, AfterRefit, testing::Values("certified", "paper", "all_faces"));

/// Fails if a guard moves after a refit of its index, or does not move before it.
void expect_standstill_after_refit(const MotionConstraintSettings& settings,
                                   const std::vector<Guide>& guides) {
  const Surface cube = make_cube(5.0);
  const auto mesh = mesh_of(cube);
  const auto tree = std::make_shared<WideBvh>(mesh);
  auto guard = make_motion_constraint(mesh, tree, settings);
  guard.set_guides(guides);
  const double top = mesh->bounds().high.z();
  const Motion motion{.tip = Vec3(0.3, 0.2, top + 2.0), .desired = Vec3(0.1, 0.0, -0.1)};
  EXPECT_NE(guard.step(motion).motion, Vec3::Zero());
  tree->refit(mesh_of(moved(cube, Vec3(0.0, 0.0, 0.1))));
  const Step step = guard.step(motion);
  EXPECT_EQ(step.status, Status::mesh_changed);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(AfterRefit, NoStepMovesWithGuides) {
  const Vec3 out(-1.0, 0.0, 0.0);  // the guide pulls the tip back
  expect_standstill_after_refit({.options = {.radius = 5.0, .margin = 0.2}},
                                {Guide::point("side", Region::half_space(out, out))});
}

TEST(AfterRefit, NoStepMovesAConvexTool) {
  expect_standstill_after_refit({.options = {.radius = 5.0, .margin = 0.2},
                                 .tool = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)})},
                                {});
}

// The mesh and the index that a running guard uses cannot be replaced.

TEST(WhatAGuardRestsOn, IsNotAssignedTo) {
  EXPECT_FALSE(std::is_copy_assignable_v<WideBvh>);
  EXPECT_FALSE(std::is_move_assignable_v<WideBvh>);
  EXPECT_FALSE(std::is_copy_assignable_v<Mesh>);
  EXPECT_FALSE(std::is_move_assignable_v<Mesh>);
}

TEST(IndexOfAnotherMesh, IsRefused) {
  const auto mesh = mesh_of(make_cube(5.0));
  const auto other = mesh_of(moved(make_cube(5.0), Vec3(0.0, 0.0, 3.0)));
  const std::vector<std::shared_ptr<const SpatialIndex>> indices{
      std::make_shared<WideBvh>(other), std::make_shared<PdTree>(other),
      std::make_shared<PdTree1997>(other), std::make_shared<BruteForce>(other)};
  for (const auto& index : indices) {
    EXPECT_THROW(make_motion_constraint(mesh, index, {.options = {.radius = 5.0}}), Error);
    EXPECT_NO_THROW(make_motion_constraint(other, index, {.options = {.radius = 5.0}}));
  }
}

// Vertices that no triangle uses do not change a step. A distant origin changes it only by
// rounding.

TEST(CoordinatesOf, VerticesThatNoTriangleUsesChangeNothing) {
  Surface surface = enlarged(make_shape("gear"), 1.0 / 3.0);  // not exact in single precision
  Surface with_one_more = surface;
  with_one_more.vertices.emplace_back(3e7 / 7.0, -3e7, 3e7);
  const MotionConstraintSettings settings{.options = {.radius = 1.0, .margin = 0.01}};
  Loop loop(surface, settings);
  Loop other(with_one_more, settings);
  Random random(3);
  for (const Vec3& tip : places(loop, 300, 0.05, random)) {
    const Vec3 desired = random.uniform() * random.direction();
    const Step expected = loop.step(tip, desired);
    const Step step = other.step(tip, desired);
    ASSERT_EQ(step.status, expected.status);
    ASSERT_EQ(step.motion, expected.motion);
    ASSERT_EQ(step.triangles, expected.triangles);
  }
}

TEST(CoordinatesOf, AMeshFarFromTheOriginLimitNoMore) {
  const Surface surface = enlarged(make_shape("gear"), 1.0 / 3.0);
  const Vec3 offset(1e7 / 3.0, -1e7, 1e7 / 7.0);
  const MotionConstraintSettings settings{.options = {.radius = 1.0, .margin = 0.01}};
  Loop loop(surface, settings);
  Loop far(moved(surface, offset), settings);
  Random random(3);
  std::size_t asked = 0, asked_far = 0;
  for (const Vec3& tip : places(loop, 300, 0.05, random)) {
    const Vec3 desired = random.uniform() * random.direction();
    const Step expected = loop.step(tip, desired);
    const Step step = far.step(tip + offset, desired);
    ASSERT_EQ(step.ok(), expected.ok());
    ASSERT_LE(std::abs((step.motion - desired).norm() - (expected.motion - desired).norm()), 1e-6);
    asked += expected.triangles;
    asked_far += step.triangles;
  }
  EXPECT_LE(asked_far, asked + asked / 4);
}

TEST(CoordinatesOf, AMeshTooLargeForItsMarginIsWarnedOf) {
  const auto mesh = mesh_of(enlarged(make_shape("gear"), 1e4 / 3.0));
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& text) { warnings.push_back(text); };
  make_motion_constraint(mesh, {.warn = warn, .options = {.radius = 10.0, .margin = 1.0}});
  EXPECT_TRUE(warnings.empty());
  make_motion_constraint(mesh, {.warn = warn, .options = {.radius = 10.0, .margin = 1e-2}});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "keep more than");
}

// A tip that is too close comes no closer, however small `recovery` is.

/// Pushes a tip towards the nearest triangle in each cycle, by less than the violation of a plane
/// that a step accepts. Returns the loss of distance, in tolerances.
double creep(Loop& loop, Vec3 tip, const Vec3& inwards, int cycles, Random& random) {
  NearestTriangle nearest(loop.mesh(), loop.guard().index());
  const double tau = loop.tolerance(tip);
  const double at_first = loop.distance(tip);
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const Vec3 towards = (nearest(tip).closest.offset.normalized() + inwards).normalized();
    tip += loop.step(tip, random.uniform(0.0, 0.06) * tau * towards).motion;
  }
  return (at_first - loop.distance(tip)) / tau;
}

class LittleRecovery : public testing::TestWithParam<double> {};

TEST_P(LittleRecovery, NothingAddsUp) {
  Random random(11);
  const MotionConstraintSettings settings{
      .options = {.radius = 1.0, .margin = 0.5, .recovery = GetParam()}};
  for (const char* shape : {"cube", "sphere", "gear"}) {
    SCOPED_TRACE(shape);
    Loop loop(make_shape(shape), settings);
    for (const Vec3& tip : places(loop, 3, 0.4, random)) {
      EXPECT_LE(creep(loop, tip, Vec3::Zero(), 5'000, random), 3.0);
    }
  }
}

/// Returns a groove along the y axis, open upwards, whose walls meet at `angle`. [rad]
Surface groove(double angle) {
  const double x = 20.0 * std::sin(0.5 * angle), z = 20.0 * std::cos(0.5 * angle);
  return {{{0, -20, 0}, {0, 20, 0}, {x, -20, z}, {x, 20, z}, {-x, -20, z}, {-x, 20, z}},
          {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}}};
}

/// A retreat from one wall approaches the other wall.
TEST_P(LittleRecovery, NothingAddsUpBetweenWalls) {
  Random random(12);
  const MotionConstraintSettings settings{
      .options = {.radius = 1.0, .margin = 0.5, .recovery = GetParam()}};
  for (const double angle : {0.001, 0.02, 0.3, 1.0, 1.5, 2.5}) {
    SCOPED_TRACE(angle);
    Loop loop(groove(angle), settings);
    const double height = std::min(0.4 / std::sin(0.5 * angle), 15.0);
    for (const double beside : {0.0, 1e-9, 1e-4}) {
      EXPECT_LE(creep(loop, Vec3(beside, 0.3, height), Vec3(0.0, 0.0, -3.0), 5'000, random), 3.0)
          << beside;
    }
  }
}

/// The only joint moves the tip along the surface and, by a fraction of a tolerance, into it.
TEST_P(LittleRecovery, NothingAddsUpWhereAJointCannotLeadOff) {
  const MotionConstraintSettings settings{
      .options = {.radius = 1.0, .margin = 1.0, .recovery = GetParam()}};
  Loop loop({{{-50, 0, -50}, {50, 0, -50}, {0, 0, 80}}, {{0, 1, 2}}}, settings);
  for (const double share : {0.003, 0.012, 0.0155, 0.03}) {
    SCOPED_TRACE(share);
    Vec3 tip(-1.0, 1.0, 0.0);
    const double tau = loop.tolerance(tip);
    const Eigen::Matrix<double, 3, 1> jacobian(1.0, -share * tau / 1e-4, 0.0);
    for (int cycle = 0; cycle < 20'000; ++cycle) {
      const Vec3 desired = 1e-4 * jacobian;
      tip += loop.guard().step({.tip = tip, .desired = desired, .jacobian = jacobian}).motion;
    }
    EXPECT_GE(loop.distance(tip), 1.0 - 3.5 * tau);
  }
}

/// Both walls are nearer to the middle of the slot than the margin.
TEST_P(LittleRecovery, LeadsToTheMiddleOfASlotAndKeepsItThere) {
  const MotionConstraintSettings settings{
      .options = {.radius = 1.0, .margin = 1.0, .recovery = GetParam()}};
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  for (const double off : {0.0, 1e3, 1e6}) {
    SCOPED_TRACE(off);
    const Vec3 origin = off * Vec3(1.0, -0.7, 0.3);
    Surface slot;
    for (const double y : {0.5, -0.5}) {
      const auto first = static_cast<VertexId>(slot.vertices.size());
      for (const auto& [x, z] : {std::pair(-10, -10), {10, -10}, {-10, 10}, {10, 10}}) {
        slot.vertices.push_back(turn * Vec3(x, y, z) + origin);
      }
      slot.triangles.push_back({first, first + 1, first + 2});
      slot.triangles.push_back({first + 1, first + 3, first + 2});
    }
    Loop loop(std::move(slot), settings);
    for (const double beside : {0.0, 0.05, 0.2}) {
      Vec3 tip = turn * Vec3(0.0, beside, 0.0) + origin;
      const double tau = loop.tolerance(tip);
      const double at_first = loop.distance(tip);
      for (int cycle = 0; cycle < 10'000; ++cycle) {
        const Vec3 along = turn * Vec3(cycle % 2 == 0 ? 1.3e-4 : -1.3e-4, 0.0, 0.0);
        tip += loop.step(tip, along).motion;
      }
      EXPECT_GE(loop.distance(tip), at_first - 3.0 * tau) << beside;
      const double due = GetParam() > 1e-3 ? 0.499 : 0.0;
      EXPECT_GE(loop.distance(tip), due) << beside;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Recoveries, LittleRecovery,
                         testing::Values(0.0, 1e-30, 1e-12, 0.007, 0.05, 0.2));

// A result has no negative zero.

TEST(SignOfZero, IsPlusWhateverItWasInWhatGoesIn) {
  auto guard = make_motion_constraint(mesh_of(make_cube(5.0)), {.options = {.radius = 5.0}});
  const auto expect_plus = [&](const Motion& motion) {
    const Step step = guard.step(motion);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_FALSE(step.motion[axis] == 0.0 && std::signbit(step.motion[axis]));
    }
    for (const double u : step.increment) EXPECT_FALSE(u == 0.0 && std::signbit(u));
  };
  const Eigen::Matrix3d jacobian = Vec3(1.0, -1.0, 1.0).asDiagonal();
  for (const double x : {0.0, -0.0}) {
    for (const double z : {60.0, 50.5, 50.1, 40.0, 1000.0}) {
      for (const Vec3& desired : {Vec3(-0.0, x, -0.0), Vec3(x, 1.0, -0.0), Vec3(-x, -0.0, -4.0)}) {
        expect_plus({.tip = Vec3(x, -0.0, z), .desired = desired});
        expect_plus({.tip = Vec3(x, -0.0, z), .desired = desired, .jacobian = jacobian});
      }
    }
  }
}

}  // namespace
}  // namespace keepout::test::promises
