// SPDX-License-Identifier: BSD-3-Clause
#include "guards.h"
#include "keepout/activation/all_faces.h"
#include "keepout/activation/paper.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"

namespace keepout {
namespace {

template <class Rule>
MotionConstraint guard(const std::shared_ptr<const Mesh>& mesh, const StepOptions& options,
                       const Capacity& capacity = {}) {
  return guard_of<PdTree>(mesh, options, std::make_unique<ActiveSet>(), std::make_unique<Rule>(),
                          capacity);
}

// The cube's faces are at +-50.

TEST(Step, AMotionInFreeSpaceComesBackUnchanged) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0});
  const Step step = constraint.step({.tip = {0, 0, 70}, .desired = {1.1, -2.3, 0.7}});
  EXPECT_EQ(step.status, Status::free);
  EXPECT_EQ(step.motion, Vec3(1.1, -2.3, 0.7));
  EXPECT_EQ(step.triangles, 0u);
}

TEST(Step, AMotionIntoAFaceSlidesAlongIt) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0});
  const Step step = constraint.step({.tip = {3, 4, 51}, .desired = {1, -2, -3}});
  EXPECT_EQ(step.status, Status::limited);
  EXPECT_LT((step.motion - Vec3(1, -2, -1)).norm(), 1e-12);
  ASSERT_FALSE(step.active.empty());
  const HalfSpace& plane = step.planes[step.active[0]];
  EXPECT_NEAR(plane.normal.dot(step.motion), plane.offset, 1e-12);
  EXPECT_EQ(plane.normal, constraint.mesh().normal(plane.source));
}

TEST(Step, RetreatingFromContactIsNotSlowed) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0});
  const Step step = constraint.step({.tip = {3, 4, 50}, .desired = {1, -2, 3}});
  EXPECT_EQ(step.status, Status::free);
  EXPECT_LT((step.motion - Vec3(1, -2, 3)).norm(), 1e-15);
}

TEST(Step, TheMarginIsKept) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 2.0, .margin = 0.5});
  const Step step = constraint.step({.tip = {3, 4, 51}, .desired = {0, 0, -2}});
  EXPECT_EQ(step.status, Status::limited);
  EXPECT_LT((step.motion - Vec3(0, 0, -0.5)).norm(), 1e-12);
}

TEST(Step, ATipWithinTheMarginIsPushedOut) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 2.0, .margin = 0.5});
  const Step step = constraint.step({.tip = {3, 4, 50.2}, .desired = {0, 0, 0}});
  EXPECT_EQ(step.status, Status::limited);
  EXPECT_LT((step.motion - Vec3(0, 0, 0.3)).norm(), 1e-12);
}

TEST(Step, AMarginThatNoMotionCanKeepMeansNoMotion) {
  // The gap between the plates is 1, half a millimeter too narrow for the margin on both sides.
  auto constraint = guard<PaperRule>(mesh_of("thin_plates"), {.radius = 2.0, .margin = 0.75});
  const Box& bounds = constraint.mesh().bounds();
  const Vec3 in_the_gap(0, 0, bounds.low.z() + 1.5);
  const Step step = constraint.step({.tip = in_the_gap, .desired = {0.1, 0, 0}});
  EXPECT_EQ(step.status, Status::infeasible);
  EXPECT_EQ(step.motion, Vec3::Zero());
  EXPECT_FALSE(step.planes.empty()) << "what made it infeasible should be told";
}

TEST(Step, BadInputIsAStatusAndNoMotion) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0});
  for (const double bad : {test::nan, test::infinity, -test::infinity, 1e31}) {
    for (int axis = 0; axis < 3; ++axis) {
      Motion motion{.tip = {0, 0, 51}, .desired = {0, 0, -1}};
      motion.tip[axis] = bad;
      EXPECT_EQ(constraint.step(motion).status, Status::invalid_input);
      EXPECT_EQ(constraint.step(motion).motion, Vec3::Zero());
      motion = {.tip = {0, 0, 51}, .desired = {0, 0, -1}};
      motion.desired[axis] = bad;
      EXPECT_EQ(constraint.step(motion).status, Status::invalid_input);
      EXPECT_EQ(constraint.step(motion).motion, Vec3::Zero());
    }
  }
  // The next cycle is not affected.
  EXPECT_TRUE(constraint.step({.tip = {0, 0, 51}, .desired = {0, 0, -1}}).ok());
}

TEST(Step, MoreThanTheMotionSphereIsRefused) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 1.0, .margin = 0.0});
  const Step step = constraint.step({.tip = {0, 0, 60}, .desired = {0, 0, -1.01}});
  EXPECT_EQ(step.status, Status::beyond_reach);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(Step, TooManyTrianglesOrPlanesIsAStatusAndNoMotion) {
  const auto mesh = mesh_of("sphere");
  for (const Capacity& capacity : {Capacity{.triangles = 10}, Capacity{.planes = 2}}) {
    auto constraint = guard<AllFaces>(mesh, {.radius = 20.0, .margin = 0.0}, capacity);
    const Step step = constraint.step({.tip = {0, 0, 55}, .desired = {0, 0, -1}});
    EXPECT_EQ(step.status, Status::over_capacity);
    EXPECT_EQ(step.motion, Vec3::Zero());
  }
}

TEST(Step, ABudgetThatPaysForTooFewTrianglesIsNotALackOfCapacity) {
  const auto mesh = mesh_of("sphere");
  for (const std::uint64_t units : {work::hit * 10, work::hit * 10 + 1, work::hit * 11 - 1}) {
    auto constraint = guard<AllFaces>(mesh, {.radius = 20.0, .margin = 0.0}, {.work_units = units});
    const Step step = constraint.step({.tip = {0, 0, 55}, .desired = {0, 0, -1}});
    EXPECT_EQ(step.status, Status::out_of_budget) << units;
    EXPECT_EQ(step.motion, Vec3::Zero());
  }
}

TEST(Step, JointsMoveTheTipAsTheJacobianSays) {
  auto constraint =
      guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0, .damping = 1e-9});
  // Four joints: two move the tip along x and y, one moves it down at a slant, one does nothing.
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 4);
  jacobian << 1, 0, 0.5, 0,  //
      0, 2, 0.5, 0,          //
      0, 0, -1.0, 0;
  const Motion motion{.tip = {3, 4, 51}, .desired = {1, -2, -3}, .jacobian = jacobian};
  const Step step = constraint.step(motion);
  ASSERT_EQ(step.status, Status::limited) << step.reason();
  ASSERT_EQ(step.increment.size(), 4u);
  const Eigen::Map<const Eigen::VectorXd> joints(step.increment.data(), 4);
  EXPECT_LT((jacobian * joints - step.motion).norm(), 1e-12);
  EXPECT_LT((step.motion - Vec3(1, -2, -1)).norm(), 1e-6);
  EXPECT_NEAR(joints[3], 0.0, 1e-12);
}

TEST(Step, AJacobianThatLosesADirectionNeedsDamping) {
  auto constraint = guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0});
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 2);
  jacobian << 1, 2, 0, 0, 0, 0;  // both joints move the tip along x
  const Step step =
      constraint.step({.tip = {3, 4, 60}, .desired = {1, 0, 0}, .jacobian = jacobian});
  EXPECT_EQ(step.status, Status::ill_posed);
  EXPECT_EQ(step.motion, Vec3::Zero());
}

TEST(Step, MoreJointsThanRoomWasMadeForIsAStatus) {
  auto constraint =
      guard<PaperRule>(mesh_of("cube"), {.radius = 5.0, .margin = 0.0}, {.variables = 3});
  const Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Ones(3, 9);
  const Step step =
      constraint.step({.tip = {3, 4, 60}, .desired = {1, 0, 0}, .jacobian = jacobian});
  EXPECT_EQ(step.status, Status::over_capacity);
}

TEST(Step, DoesNotDependOnTheIndex) {
  const auto mesh = mesh_of("cortex");
  const StepOptions options{.radius = 5.0, .margin = 0.1};
  auto with_tree = guard<PaperRule>(mesh, options);
  auto with_brute = guard_of<BruteForce>(mesh, options, std::make_unique<ActiveSet>(),
                                         std::make_unique<PaperRule>());
  Random random(8);
  for (const Vec3& tip : surface_points(*mesh, 300, 1.0, random)) {
    const Vec3 desired = random.direction() * 2.0;
    const Step a = with_tree.step({.tip = tip, .desired = desired});
    const Step b = with_brute.step({.tip = tip, .desired = desired});
    ASSERT_EQ(a.status, b.status);
    ASSERT_EQ(a.motion, b.motion);
    ASSERT_EQ(a.triangles, b.triangles);
    // On the tree, the rule omits idle planes.
    ASSERT_LE(a.planes.size(), b.planes.size());
    ASSERT_EQ(a.active.size(), b.active.size());
    for (std::size_t i = 0; i < a.active.size(); ++i) {
      ASSERT_EQ(a.planes[a.active[i]].source, b.planes[b.active[i]].source);
      ASSERT_EQ(a.planes[a.active[i]].normal, b.planes[b.active[i]].normal);
      ASSERT_EQ(a.planes[a.active[i]].offset, b.planes[b.active[i]].offset);
    }
  }
}

/// The planes of AllFaces, one at a time: each trial motion is rejected with the face that it
/// violates most. Must give the same motion as the eager rule.
class LazyFaces final : public ActivationRule {
 public:
  LazyFaces() : planes_(100'000) {}

  void prepare(Neighborhood& near) override { eager_.prepare(near); }

  bool gather(const RuleInput& input) noexcept override { return eager_.gather(input); }

  Opening open(const RuleInput& input, HalfSpaceBuffer&) noexcept override {
    planes_.clear();
    return eager_.open(input, planes_);
  }

  Judgement judge(const RuleInput&, const Vec3& trial, HalfSpaceBuffer& planes) noexcept override {
    const HalfSpace* worst = nullptr;
    double shortfall = 1e-12;
    for (const HalfSpace& plane : planes_) {
      const double lacks = plane.offset - plane.normal.dot(trial);
      if (lacks > shortfall) {
        shortfall = lacks;
        worst = &plane;
      }
    }
    if (worst == nullptr) return {Judgement::Verdict::accepted};
    planes.push(*worst);
    return {Judgement::Verdict::objected, 0.0};
  }

 private:
  AllFaces eager_;
  HalfSpaceBuffer planes_;
};

TEST(Step, ARuleThatHandsOverPlanesOneAtATimeComesToTheSameMotion) {
  const auto mesh = mesh_of("saddle_terrain");
  const StepOptions options{.radius = 8.0, .margin = 0.0};
  auto eager = guard<AllFaces>(mesh, options);
  auto lazy = guard<LazyFaces>(mesh, options);
  Random random(9);
  std::size_t several = 0;
  for (const Vec3& tip : surface_points(*mesh, 500, 1.0, random)) {
    const Vec3 desired = random.direction() * 6.0;
    const Step a = eager.step({.tip = tip, .desired = desired});
    const Vec3 motion = a.motion;
    const Step b = lazy.step({.tip = tip, .desired = desired});
    ASSERT_EQ(a.status, b.status);
    ASSERT_LT((motion - b.motion).norm(), 1e-10);
    ASSERT_LE(b.planes.size(), a.planes.size());
    several += b.planes.size() > 1;
  }
  EXPECT_GT(several, 50u) << "too easy to mean anything";
}

TEST(Step, TellsWhatEachStageTook) {
  auto constraint = guard<PaperRule>(mesh_of("sphere"), {.radius = 10.0, .margin = 0.0});
  StageTimes times;
  constraint.step({.tip = {0, 0, 51}, .desired = {0, 0, -2}}, times);
  EXPECT_GT(times.query, 0);
  EXPECT_GT(times.activation, 0);
  EXPECT_GT(times.solve, 0);
  EXPECT_EQ(times.total(), times.query + times.activation + times.solve);
}

TEST(MotionConstraint, TellsToolRadiusAndMarginApartAndKeepsBoth) {
  const auto mesh = mesh_of("cube");
  auto by_hand = guard<PaperRule>(mesh, {.radius = 2.0, .tool_radius = 0.3, .margin = 0.2});
  auto by_name =
      make_motion_constraint(mesh, {.options = {.radius = 2.0, .tool_radius = 0.3, .margin = 0.2}});
  for (MotionConstraint* constraint : {&by_hand, &by_name}) {
    EXPECT_EQ(constraint->options().tool_radius, 0.3);
    EXPECT_EQ(constraint->options().margin, 0.2);
    EXPECT_EQ(required_clearance(constraint->options()), 0.5);
    const Step step = constraint->step({.tip = {3, 4, 51}, .desired = {0, 0, -2}});
    EXPECT_LT((step.motion - Vec3(0, 0, -0.5)).norm(), 1e-12);
  }
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = 1.0, .tool_radius = -0.1, .margin = 0.0}), Error);
}

TEST(MotionConstraint, RefusesOptionsOutOfRange) {
  const auto mesh = mesh_of("cube");
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = 0.0, .margin = 0.0}), Error);
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = -1.0, .margin = 0.0}), Error);
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = std::nan("")}), Error);
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = 1.0, .margin = -0.1}), Error);
  EXPECT_THROW(guard<PaperRule>(mesh, {.radius = 1.0, .margin = 0.0, .damping = -0.1}), Error);
  EXPECT_THROW(MotionConstraint(mesh, nullptr, nullptr, nullptr, {.radius = 1.0, .margin = 0.0}),
               Error);
}

}  // namespace
}  // namespace keepout
