// SPDX-License-Identifier: BSD-3-Clause
// No component is trusted: if a solver, a rule or the caller is wrong, the tip does not move.

#include <array>

#include "guards.h"
#include "keepout/activation/paper.h"
#include "keepout/error.h"
#include "keepout/index/pd_tree.h"
#include "stub_solver.h"

namespace keepout {
namespace {

MotionConstraint paper_guard(const std::shared_ptr<const Mesh>& mesh,
                             const StepOptions& options = {.radius = 5.0, .margin = 0.0},
                             std::unique_ptr<Solver> solver = std::make_unique<ActiveSet>()) {
  return guard_of<PdTree>(mesh, options, std::move(solver), std::make_unique<PaperRule>());
}

MotionConstraint guard_with(std::unique_ptr<Solver> solver) {
  return paper_guard(mesh_of("cube"), {.radius = 5.0, .margin = 0.0}, std::move(solver));
}

const Vec3 above_the_cube(3, 4, 50.5);  // its faces are at +-50

TEST(StepSafety, ASolverThatClaimsOptimalityForAMotionIntoTheMeshIsNotBelieved) {
  auto constraint = guard_with(liar());
  const Step step = constraint.step({.tip = above_the_cube, .desired = {0, 0, -1}});
  EXPECT_EQ(step.status, Status::unsolved);
  EXPECT_EQ(step.motion, Vec3::Zero());
  EXPECT_TRUE(step.increment.empty());
  // A valid answer is accepted.
  EXPECT_EQ(constraint.step({.tip = above_the_cube, .desired = {0, 0, 1}}).status, Status::free);
}

TEST(StepSafety, ASolverThatReturnsNoNumberIsNotBelieved) {
  const std::array<double, 3> broken{0.0, std::nan(""), 0.0};
  auto constraint = guard_with(solver_that([&](const StepProblem&, Solution& solution) {
    solution.u = broken;
    return SolveStatus::optimal;
  }));
  for (const Vec3& tip : {above_the_cube, Vec3(0, 0, 90)}) {
    const Step step = constraint.step({.tip = tip, .desired = {0, 0, -1}});
    EXPECT_FALSE(step.ok());
    EXPECT_EQ(step.motion, Vec3::Zero());
  }
}

TEST(StepSafety, ASolverThatClaimsOptimalityAndGivesNothingIsNotBelieved) {
  auto constraint =
      guard_with(solver_that([](const StepProblem&, Solution&) { return SolveStatus::optimal; }));
  const Step step = constraint.step({.tip = above_the_cube, .desired = {0, 0, -1}});
  EXPECT_EQ(step.status, Status::unsolved);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(StepSafety, APartOfATrialHasNoActiveRowsOfALostSolution) {
  const std::array<std::uint32_t, 1> first_row{0};
  int solves = 0;
  auto constraint =
      guard_of<PdTree>(mesh_of("cube"), {.radius = 5.0, .margin = 0.2},
                       solver_that([&](const StepProblem& problem, Solution& solution) {
                         if (++solves > 1) return SolveStatus::iteration_limit;
                         solution.u = {problem.desired.data(), 3};
                         solution.active = first_row;
                         return SolveStatus::optimal;
                       }));
  const Step step = constraint.step({.tip = above_the_cube, .desired = {0, 0, -1}});
  EXPECT_EQ(step.status, Status::truncated);
  EXPECT_EQ(solves, 2);
  EXPECT_NEAR(step.motion.z(), -0.3, 1e-6);
  EXPECT_TRUE(step.active.empty());
}

TEST(StepSafety, IterationsOfASolverSpendTheBudget) {
  int iterations = 1;
  auto constraint =
      guard_of<PdTree>(mesh_of("cube"), {.radius = 5.0, .margin = 0.2},
                       solver_that([&](const StepProblem& problem, Solution& solution) {
                         solution.u = {problem.desired.data(), 3};
                         solution.iterations = iterations;
                         return SolveStatus::optimal;
                       }));
  const Motion motion{.tip = above_the_cube, .desired = {0, 0, 0.5}};
  EXPECT_TRUE(constraint.step(motion).ok());
  const std::size_t with_one = constraint.work_units();
  iterations = 101;
  EXPECT_TRUE(constraint.step(motion).ok());
  EXPECT_GE(constraint.work_units(), with_one + 100 * work::iteration);
}

TEST(StepSafety, AnAbsurdCapacityIsRefusedBeforeMemoryIsAskedFor) {
  const auto mesh = mesh_of("cube");
  for (const Capacity& capacity :
       {Capacity{.planes = ~std::size_t{0}}, Capacity{.variables = ~std::size_t{0}}}) {
    EXPECT_THROW(make_motion_constraint(mesh, {.capacity = capacity}), Error);
  }
}

TEST(StepSafety, ARuleThatObjectsForEverEndsInAStatus) {
  class Grumbler final : public ActivationRule {
   public:
    Opening open(const RuleInput&, HalfSpaceBuffer&) noexcept override { return {}; }
    Judgement judge(const RuleInput&, const Vec3&, HalfSpaceBuffer& planes) noexcept override {
      planes.push({Vec3::UnitX(), -1.0, 0});  // no trial here violates this plane
      return {Judgement::Verdict::objected, 0.0};
    }
  };
  auto constraint = guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.0},
                             std::make_unique<ActiveSet>(), std::make_unique<Grumbler>());
  const Step step = constraint.step({.tip = above_the_cube, .desired = {0, 0, -1}});
  EXPECT_EQ(step.status, Status::unsolved);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(StepSafety, AlmostSingularJacobiansNeverTakeTheTipIn) {
  auto constraint = paper_guard(mesh_of("cube"));
  Random random(1);
  std::size_t moved = 0, refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    // The second joint moves the tip almost as the first does.
    const double difference = std::pow(10.0, random.uniform(-14.0, 0.0));
    TipJacobian::Matrix jacobian(3, 3);
    jacobian.col(0) = random.direction();
    jacobian.col(1) = jacobian.col(0) + difference * random.direction();
    jacobian.col(2) = random.direction();
    const Vec3 desired = random.direction();
    const Step step =
        constraint.step({.tip = above_the_cube, .desired = desired, .jacobian = jacobian});
    ASSERT_GE(above_the_cube.z() + step.motion.z(), 50.0 - 1e-9) << "difference " << difference;
    if (!step.ok()) {
      ASSERT_EQ(step.motion, Vec3::Zero());
      ++refused;
      continue;
    }
    // The increment gives the reported motion, checked in long double.
    for (int row = 0; row < 3; ++row) {
      long double sum = 0.0L;
      for (int c = 0; c < 3; ++c) {
        sum += static_cast<long double>(jacobian(row, c)) * step.increment[c];
      }
      ASSERT_NEAR(static_cast<double>(sum), step.motion[row], 1e-9);
    }
    ++moved;
  }
  EXPECT_GT(moved, 5'000u);
  EXPECT_GT(refused, 100u);
}

TEST(StepSafety, WhatIsForgottenIsRefused) {
  auto constraint = paper_guard(mesh_of("cube"));
  EXPECT_EQ(constraint.step({.tip = Vec3(0, 0, 60)}).status, Status::invalid_input);
  EXPECT_EQ(constraint.step({.desired = Vec3(0, 0, 1)}).status, Status::invalid_input);
  EXPECT_EQ(constraint.step({}).status, Status::invalid_input);
  EXPECT_THROW(paper_guard(mesh_of("cube"), {.radius = 0.0, .margin = 0.5}), Error);
  EXPECT_THROW(make_motion_constraint(nullptr, {}), Error);
}

TEST(StepSafety, AJacobianWithoutJointsIsNoFreeTip) {
  auto constraint = paper_guard(mesh_of("cube"));
  const TipJacobian::Matrix none(3, 0);
  const Motion motion{.tip = above_the_cube, .desired = {0, 0, 1}, .jacobian = none};
  EXPECT_EQ(constraint.step(motion).status, Status::invalid_input);
  const Motion null{
      .tip = above_the_cube, .desired = {0, 0, 1}, .jacobian = TipJacobian(nullptr, 3)};
  EXPECT_EQ(constraint.step(null).status, Status::invalid_input);
  const TipJacobian::Matrix nan = TipJacobian::Matrix::Constant(3, 3, std::nan(""));
  const Motion broken{.tip = above_the_cube, .desired = {0, 0, 1}, .jacobian = nan};
  EXPECT_EQ(constraint.step(broken).status, Status::invalid_input);
}

TEST(StepSafety, AStepClippedToTheRadiusIsNotRefusedForItsRounding) {
  auto constraint = paper_guard(mesh_of("cube"), {.radius = 0.3, .margin = 0.0});
  Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 way = 7.0 * random.direction();
    const Vec3 clipped = way * (0.3 / way.norm());
    ASSERT_EQ(constraint.step({.tip = {0, 0, 90}, .desired = clipped}).status, Status::free);
  }
}

TEST(StepSafety, ATipSoFarAwayThatAStepIsLostInItsDigitsIsRefused) {
  auto constraint = paper_guard(mesh_of("cube"));
  EXPECT_EQ(constraint.step({.tip = {1e6, 0, 0}, .desired = {0, 0, 1}}).status, Status::free);
  EXPECT_EQ(constraint.step({.tip = {1e12, 0, 0}, .desired = {0, 0, 1}}).status,
            Status::invalid_input);
}

TEST(StepSafety, AFailedSolveIsTimedAsWell) {
  const auto mesh = mesh_of("thin_plates");
  auto constraint = paper_guard(mesh, {.radius = 2.0, .margin = 0.75});
  StageTimes times;
  const Vec3 in_the_gap(0, 0, mesh->bounds().low.z() + 1.5);
  ASSERT_EQ(constraint.step({.tip = in_the_gap, .desired = {0.1, 0, 0}}, times).status,
            Status::infeasible);
  EXPECT_GT(times.solve, 0);
}

// The step checks the answers of a rule that contradicts itself.

/// Rejects every motion, but reports that all of it is free.
class Boaster final : public ActivationRule {
 public:
  Opening open(const RuleInput&, HalfSpaceBuffer&) noexcept override { return {}; }
  Judgement judge(const RuleInput&, const Vec3& trial, HalfSpaceBuffer&) noexcept override {
    if (trial.isZero(0.0)) return {Judgement::Verdict::accepted};
    return {Judgement::Verdict::blocked, 1.0};
  }
};

TEST(UntrustedRule, NoPartOfATrialIsMadeThatTheRuleRejects) {
  auto guard = guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.0},
                        std::make_unique<ActiveSet>(), std::make_unique<Boaster>());
  const Step step = guard.step({.tip = Vec3(0, 0, 60), .desired = Vec3(0, 0, -1)});
  EXPECT_FALSE(step.ok());
  EXPECT_EQ(step.motion, Vec3::Zero());
  EXPECT_TRUE(step.increment.empty());
}

}  // namespace
}  // namespace keepout
