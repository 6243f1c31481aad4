// SPDX-License-Identifier: BSD-3-Clause
// One work budget limits all work of a cycle, with guides and in a haptic proxy too.

#include "accuracy/certified_loop.h"
#include "keepout/control/haptic_proxy.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"

namespace keepout::test::work_budget {
namespace {

/// A tree that counts the triangles that its traversals visit.
class CountedTree final : public SpatialIndex {
 public:
  explicit CountedTree(const std::shared_ptr<const Mesh>& mesh) : SpatialIndex(mesh), tree_(mesh) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    tree_.collect(ball, candidates);
  }
  TriangleId nearest(const Vec3& point, Budget& budget) const noexcept override {
    return tree_.nearest(point, budget);
  }
  std::size_t memory() const noexcept override { return tree_.memory(); }
  bool traverses() const noexcept override { return true; }
  std::unique_ptr<MotionTraversal> traverse_along_motions(Budget& budget) const override {
    return std::make_unique<Traversal>(tree_.traverse_along_motions(budget), *this);
  }

  mutable std::size_t visits = 0;

 private:
  class Traversal final : public MotionTraversal, private TriangleVisitor {
   public:
    Traversal(std::unique_ptr<MotionTraversal> traversal, const CountedTree& tree)
        : traversal_(std::move(traversal)), tree_(tree) {}

    bool begin(const Start& start) noexcept override { return traversal_->begin(start); }
    void begin_again(double level) noexcept override { traversal_->begin_again(level); }
    bool region_is_empty() const noexcept override { return traversal_->region_is_empty(); }
    bool traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept override {
      visitor_ = &visitor;
      return traversal_->traversal(motion, *this);
    }
    std::size_t room() const noexcept override { return traversal_->room(); }

   private:
    double visit(TriangleId triangle, std::uint32_t& note,
                 const Triangle* corners) noexcept override {
      ++tree_.visits;
      return visitor_->visit(triangle, note, corners);
    }

    std::unique_ptr<MotionTraversal> traversal_;
    const CountedTree& tree_;
    TriangleVisitor* visitor_ = nullptr;
  };

  WideBvh tree_;
};

constexpr std::size_t stated = Capacity::work_units_of_traversals;

/// A cone. Many of its triangles are equally near to a tip at its apex.
struct Scene {
  explicit Scene(VertexId faces, double slope)
      : mesh(mesh_of(make_cone(faces, slope))), tree(std::make_shared<CountedTree>(mesh)) {}

  MotionConstraint guard() const {
    return make_motion_constraint(mesh, tree, {.options = {.radius = 5.0, .margin = 1.0}});
  }

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<CountedTree> tree;
};

constexpr double heights[] = {0.5, 0.99, 1.0, 1.5, 3.0};

Vec3 above(double height) { return {1e-4, 2e-4, height}; }

template <class Check>
void for_each_scene(const Check& check) {
  for (const VertexId faces : {400u, 4'000u, 20'000u}) {
    for (const double slope : {0.3, 1.0, 3.0}) {
      SCOPED_TRACE(testing::Message() << faces << " faces, slope " << slope);
      check(Scene(faces, slope));
    }
  }
}

/// Returns sixteen balls that contain a place near their surfaces.
std::vector<Guide> balls_about(const Vec3& place) {
  std::vector<Guide> guides;
  for (std::size_t g = 0; g < Guide::most; ++g) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(g) / Guide::most;
    const Vec3 beside(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.3);
    guides.push_back(
        Guide::point("ball", Region::ball(place + beside, 2.03 + (g % 3 == 0 ? 0.01 : 0.0))));
  }
  return guides;
}

TEST(BudgetOfACycle, HoldsUnderTheTipOfACone) {
  for_each_scene([](const Scene& scene) {
    MotionConstraint guard = scene.guard();
    for (const double height : heights) {
      scene.tree->visits = 0;
      const Step step = guard.step({.tip = above(height), .desired = Vec3(0.01, 0.02, -4.0)});
      EXPECT_LE(scene.tree->visits, stated) << name(step.status);
      EXPECT_LE(guard.work_units(), stated + stated / 64) << name(step.status);
    }
  });
}

TEST(BudgetOfACycle, HoldsWithGuides) {
  std::size_t guided = 0;
  for_each_scene([&](const Scene& scene) {
    MotionConstraint guard = scene.guard();
    for (const double height : heights) {
      guard.set_guides(balls_about(above(height)));
      scene.tree->visits = 0;
      const Step step = guard.step({.tip = above(height), .desired = Vec3(0.01, 0.02, -4.0)});
      EXPECT_LE(scene.tree->visits, stated) << name(step.status);
      EXPECT_LE(guard.work_units(), stated + stated / 64) << name(step.status);
      guided += step.limits.has(Limit::guide) ? 1 : 0;
    }
  });
  EXPECT_GE(guided, 10u);
}

// With a top speed below the solved motion, the proxy once stepped twice, and up to eight times
// each with guides.
TEST(BudgetOfACycle, HoldsInAHapticProxyWithGuides) {
  std::size_t moved = 0;
  for_each_scene([&](const Scene& scene) {
    for (const double height : heights) {
      const HapticOptions options{.top_speed = 20.0, .guides = balls_about(above(height))};
      HapticProxy proxy(scene.guard(), options);
      proxy.engage(above(height));
      for (int cycle = 0; cycle < 3; ++cycle) {
        const Vec3 before = proxy.proxy();
        scene.tree->visits = 0;
        const HapticCycle result = proxy.cycle(above(height) + Vec3(0.01, 1.0, -4.0));
        EXPECT_LE(scene.tree->visits, stated) << name(result.step);
        EXPECT_LE(proxy.work_units(), stated + stated / 64) << name(result.step);
        moved += result.proxy != before ? 1 : 0;
      }
    }
  });
  EXPECT_GE(moved, 20u);
}

/// Counts the cycles of an instrument beside three cones.
struct InstrumentCycles {
  int guided = 0;
  int stopped = 0;
  int costly = 0;
};

/// Runs cycles, and fails if one exceeds the budget. Each guide keeps the tip in a region of
/// `regions_about`. `speed` is that of two of the cones. [length/s]
InstrumentCycles instrument_cycles(std::vector<Guide> (*regions_about)(const Vec3&), double speed) {
  InstrumentCycles count;
  for_each_scene([&](const Scene& scene) {
    InstrumentConstraint guard(scene.mesh, scene.tree, free_ball(0.5),
                               std::make_unique<ActiveSet>(),
                               {.margin = 0.6, .check_sides = false});
    for (const double side : {-1.0, 1.0}) {
      const std::size_t mesh = guard.add_mesh(scene.mesh, scene.tree, 0.5);
      guard.place(mesh, {Vec3(0.3 * side, 0, -0.1)}, {.linear = Vec3(0, 0, speed)});
    }
    for (const double height : heights) {
      const Vec3 at = above(height);
      std::vector<Guide> guides;
      for (const Guide& of_tip : regions_about(at)) {
        guides.push_back(Guide::point(of_tip.name(), {3, Vec3::Zero()}, of_tip.region()));
      }
      guard.set_guides(guides);
      const InstrumentStep step = guard.step({at.data(), 3}, {.linear = Vec3(0.5, 0.02, -4.0)});
      EXPECT_LE(guard.work_units(), stated + stated / 64) << name(step.status);
      EXPECT_TRUE(step.ok() || step.increment.empty()) << name(step.status);
      count.guided += step.limits.has(Limit::guide) ? 1 : 0;
      count.stopped += step.ok() ? 0 : 1;
      count.costly += guard.work_units() > stated / 2 ? 1 : 0;
      guard.prove({at.data(), 3}, std::vector<double>{0.1, 0.0, -4.0});
      EXPECT_LE(guard.work_units(), stated + stated / 64) << "of the last part of a proof";
    }
  });
  return count;
}

TEST(BudgetOfACycle, HoldsForAnInstrumentBesideMovingMeshes) {
  const InstrumentCycles count =
      instrument_cycles([](const Vec3&) { return std::vector<Guide>(); }, 200.0);
  EXPECT_EQ(count.guided, 0);
  EXPECT_GT(count.stopped, 5);
  EXPECT_GT(count.costly, 5);
}

// A cone approaches a fixed post from below, and the proof for the post exceeds the budget. A ball
// far away still retreats from a plate.
TEST(BudgetOfACycle, IsNotSpentByABodyThatCannotGiveWay) {
  const Scene cone(400, 0.3);
  const auto plate = mesh_of(make_flat_plate(20.0, 1));
  const Instrument ball = free_ball(0.5);
  Instrument instrument(ball.chain(), {{"post", {{0, Vec3(0, 0, 0)}}, 0.1}, ball.bodies()[0]});
  InstrumentConstraint guard(cone.mesh, cone.tree, std::move(instrument),
                             std::make_unique<ActiveSet>(), {.margin = 0.2, .check_sides = false});
  const std::size_t second = guard.add_mesh(plate, std::make_shared<WideBvh>(plate));
  guard.place(0, {Vec3(0, 0, -0.32)}, {.linear = Vec3(0, 0, 3000)});
  guard.place(second, {Vec3(100, 0, 0)}, {.linear = Vec3(0, 0, 300)});
  const Vec3 at(100, 0, 0.75);
  const InstrumentStep step = guard.step({at.data(), 3}, {.linear = Vec3(0.1, 0, -0.2)});
  ASSERT_TRUE(step.ok()) << name(step.status);
  EXPECT_GE(step.increment[2], 0.25 - 1e-9) << "with the plate, which approaches by 0.3";
  for (const DegradedClearance& pair : step.degraded) EXPECT_EQ(pair.body, 0);
}

TEST(BudgetOfACycle, HoldsForAnInstrumentWithGuides) {
  const InstrumentCycles count = instrument_cycles(balls_about, 0.0);
  EXPECT_GT(count.guided, 10);
  EXPECT_GT(count.stopped, 5);
  EXPECT_GT(count.costly, 5);
}

// The proofs of a convex tool once spent nothing: this step took 200 ms.
TEST(BudgetOfACycle, EndsForAConvexTool) {
  const Scene cone(4'000, 1.0);
  const auto status = [&](std::size_t work_units) {
    MotionConstraint guard = make_motion_constraint(
        cone.mesh, {.options = {.radius = 5.0, .margin = 0.2},
                    .tool = ConvexTool::box({Vec3(-0.8, -0.8, -0.8), Vec3(0.8, 0.8, 2.0)}),
                    .capacity = {.work_units = work_units}});
    return guard.step({.tip = above(1.05), .desired = Vec3(0.01, 0.02, -4.0)}).status;
  };
  EXPECT_TRUE(is_ok(status(Budget::unlimited)));
  EXPECT_EQ(status(0), Status::out_of_budget);
}

// Testing faces one by one once used half of the budget, in 613 of 100,000 steps, without a motion.
TEST(BudgetOfACycle, SufficesInsideConesOfUpTo400Faces) {
  Random random(3);
  int found = 0;
  const int count = trials(300);
  for (int i = 0; i < count; ++i) {
    const auto faces = static_cast<VertexId>(100 + random.below(301));
    const double slope = -random.uniform(1.0, 6.0);
    SCOPED_TRACE(testing::Message() << faces << " faces, slope " << slope);
    const Scene scene(faces, slope);
    MotionConstraint guard = scene.guard();
    const double height = std::sqrt(1.0 + 1.0 / (slope * slope));  // at the distance of the margin
    const Vec3 tip = random.uniform(0.7, 0.999) * Vec3(0, 0, height) + 1e-3 * random.direction();
    const Vec3 desired = random.uniform(0.1, 4.0) * random.direction();
    const Step step = guard.step({.tip = tip, .desired = desired});
    EXPECT_EQ(step.status, Status::recovering);
    found += step.motion.norm() > 0.0 ? 1 : 0;
  }
  EXPECT_EQ(found, count);
}

TEST(BudgetOfACycle, EndsInAStatusOfItsOwn) {
  const Scene scene(4'000, 1.0);
  const auto status = [&](const char* index, const Capacity& capacity) {
    MotionConstraint guard =
        make_motion_constraint(scene.mesh, {.index = index,
                                            .options = {.radius = 5.0, .margin = 1.0},
                                            .inside = Inside::taken_as_is,
                                            .capacity = capacity});
    return guard.step({.tip = above(0.99), .desired = Vec3(0.01, 0.02, -4.0)}).status;
  };
  EXPECT_EQ(status("wide_bvh", {.work_units = 300}), Status::out_of_budget);
  EXPECT_EQ(status("pd_tree", {.work_units = 300}), Status::out_of_budget);
  EXPECT_EQ(status("pd_tree", {.triangles = 100}), Status::over_capacity);
  EXPECT_TRUE(is_ok(status("wide_bvh", {.triangles = 100, .work_units = Budget::unlimited})))
      << "a traversal needs no capacity for candidates";
}

// The work budget or the memory of a step runs out at an arbitrary point. The step is then safe, or
// it has no motion.

TEST(SpentBudget, NoStepIsUnsafeWhereverTheWorkEnds) {
  Random random(3);
  int moved = 0;
  int stopped = 0;
  for (int trial = 0; trial < trials(50); ++trial) {
    MotionConstraintSettings settings{.options = {.radius = 3.0, .margin = 0.5}};
    settings.capacity.work_units = static_cast<std::size_t>(std::exp2(random.uniform(2.0, 16.0)));
    constexpr const char* names[] = {"gear", "cortex", "sphere", "fan"};
    Loop loop(
        trial % 5 == 4 ? make_cone(3000, random.uniform(0.1, 2.0)) : make_shape(names[trial % 5]),
        settings);
    SCOPED_TRACE(testing::Message()
                 << "trial " << trial << ", work units " << settings.capacity.work_units);
    for (const Vec3& tip : places(loop, 6, random.uniform(0.05, 0.8), random)) {
      for (int i = 0; i < 6; ++i) {
        const Step step = loop.step(tip, random.uniform(0.1, 3.0) * random.direction());
        stopped += step.ok() ? 0 : 1;
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, step, moved));
      }
    }
  }
  EXPECT_GT(moved, trials(200));
  EXPECT_GT(stopped, trials(50));
}

// The tip is above a cone of many faces. The budget suffices, but the memory for prepared and for
// deferred triangles does not.
TEST(SpentBudget, NoStepIsUnsafeWhereMoreTrianglesAreNearThanFitInMemory) {
  Random random(4);
  int moved = 0;
  for (const VertexId faces : {3000u, 30000u}) {
    for (const double slope : {0.05, 0.3, 1.0}) {
      MotionConstraintSettings settings{.options = {.radius = 5.0, .margin = 1.0}};
      settings.capacity.work_units = std::size_t{1} << 30;
      Loop loop(make_cone(faces, slope), settings);
      SCOPED_TRACE(testing::Message() << faces << " faces, slope " << slope);
      for (int i = 0; i < trials(8); ++i) {
        const Vec3 tip(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                       random.uniform(1.0, 2.0));
        const Vec3 desired(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                           random.uniform(-3.0, -0.1));
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
      }
    }
  }
  EXPECT_GT(moved, trials(10));
}

}  // namespace
}  // namespace keepout::test::work_budget
