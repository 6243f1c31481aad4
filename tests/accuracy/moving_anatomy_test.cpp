// SPDX-License-Identifier: BSD-3-Clause
// Anatomy moves during a running loop: no step uses an outdated mesh.

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "accuracy/certified_loop.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"

namespace keepout::test::moving_anatomy {
namespace {

constexpr double margin = 0.5;
constexpr double radius = 2.0;

std::shared_ptr<const Mesh> at(const Surface& still, double time) {
  return mesh_of(beating(still, time));
}

MotionConstraint guard_of(const std::shared_ptr<const Mesh>& mesh,
                          const std::shared_ptr<const SpatialIndex>& index) {
  return make_motion_constraint(mesh, index, {.options = {.radius = radius, .margin = margin}});
}

/// Fails if a step breaks a promise. Returns the next position of the tip.
Vec3 stepped(MotionConstraint& guard, oracle::TipJudge& judge, const Vec3& tip,
             const Vec3& desired) {
  const Motion motion{.tip = tip, .desired = desired};
  const Step step = guard.step(motion);
  const oracle::TipVerdict verdict = judge.judge(motion, step);
  EXPECT_FALSE(verdict.breach.has_value()) << name(*verdict.breach) << ", " << name(step.status);
  return tip + step.motion;
}

TEST(MovingAnatomy, IsFollowedOnAnIndexThatIsRefit) {
  for (const char* shape : {"sphere", "cortex"}) {
    SCOPED_TRACE(shape);
    const Surface still = make_shape(shape);
    auto mesh = at(still, 0.0);
    const auto tree = std::make_shared<WideBvh>(mesh);
    MotionConstraint guard = guard_of(mesh, tree);
    Random random(1);
    Vec3 tip = surface_points(*mesh, 1, 2.0 * margin, random).front();
    std::size_t held = 0;
    for (int beats = 1; beats <= trials(20); ++beats) {
      mesh = at(still, 0.1 * beats);
      tree->refit(mesh);
      const Step stale = guard.step({.tip = tip, .desired = Vec3(0.1, 0.0, 0.0)});
      ASSERT_EQ(stale.status, Status::mesh_changed);
      ASSERT_EQ(stale.motion, Vec3::Zero());
      ASSERT_FALSE(guard.is_current());
      ASSERT_EQ(guard.free_polytope(tip, radius).status, Status::mesh_changed);
      ASSERT_EQ(guard.free_polytope(tip, radius).planes.size(), planes_to_hold_still);

      guard.follow(mesh, tree);
      ASSERT_TRUE(guard.is_current());
      ASSERT_EQ(&guard.mesh(), mesh.get());
      MotionConstraint anew = guard_of(mesh, tree);
      const oracle::JudgedSurface judged(mesh);
      oracle::TipJudge judge(judged, guard.options(), true, tip);
      for (int cycle = 0; cycle < 20; ++cycle) {
        const Vec3 desired = 0.5 * (random.direction() - tip.normalized());
        const Vec3 to = stepped(guard, judge, tip, desired);
        ASSERT_EQ(to, tip + anew.step({.tip = tip, .desired = desired}).motion);
        held += to != tip + desired;
        tip = to;
        if (HasFatalFailure()) return;
      }
    }
    EXPECT_GT(held, 50u);
  }
}

/// Prepares the next index in a thread, while the loop runs with the last one.
class Watcher {
 public:
  struct Anatomy {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const SpatialIndex> index;
  };

  Watcher(Surface still, Anatomy now, std::chrono::milliseconds period)
      : still_(std::move(still)), now_(std::move(now)), thread_([this, period] { run(period); }) {}
  ~Watcher() {
    stop_ = true;
    thread_.join();
  }

  Anatomy now() {
    const std::lock_guard lock(mutex_);
    return now_;
  }

 private:
  void run(std::chrono::milliseconds period) {
    Anatomy last = now();
    auto due = std::chrono::steady_clock::now();
    for (int i = 1; !stop_; ++i) {
      const auto mesh = at(still_, 0.1 * i);
      last = {mesh, last.index->refitted(mesh)};
      std::this_thread::sleep_until(due += period);
      const std::lock_guard lock(mutex_);
      now_ = last;
    }
  }

  Surface still_;
  std::mutex mutex_;
  Anatomy now_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST(MovingAnatomy, IsFollowedTenTimesASecondUnderARunningLoop) {
  const Surface still = make_shape("cortex");
  const auto mesh = at(still, 0.0);
  const auto tree = std::make_shared<WideBvh>(mesh);
  MotionConstraint guard = guard_of(mesh, tree);
  Watcher watcher(still, {mesh, tree}, std::chrono::milliseconds(100));
  Random random(2);
  Vec3 tip = surface_points(*mesh, 1, 2.0 * margin, random).front();
  auto judged = std::make_unique<oracle::JudgedSurface>(mesh);
  oracle::TipJudge judge(*judged, guard.options(), true, tip);
  int follows = 0, held = 0;
  while (follows < trials(20)) {
    const Watcher::Anatomy now = watcher.now();
    if (&guard.mesh() != now.mesh.get()) {
      guard.follow(now.mesh, now.index);
      judged = std::make_unique<oracle::JudgedSurface>(now.mesh);
      judge = {*judged, guard.options(), true, tip};
      ++follows;
    }
    const Vec3 desired = 0.2 * (random.direction() - tip.normalized());
    const Vec3 to = stepped(guard, judge, tip, desired);
    held += to != tip + desired;
    tip = to;
    if (HasFailure()) return;
  }
  EXPECT_GT(held, 10 * follows);
}

TEST(MovingAnatomy, WatchesOfTheCallersOwnAreOfTheMeshTheyWereMadeOn) {
  // A wall of the cube moves over a tip that the last step left nearby, on the free side.
  const Surface cube = make_cube(5.0);
  const auto mesh = mesh_of(cube);
  const auto tree = std::make_shared<WideBvh>(mesh);
  MotionConstraint guard = guard_of(mesh, tree);
  SideWatch sides;
  const Vec3 tip(0.3, 0.2, mesh->bounds().high.z() + 2.0 * margin);
  ASSERT_EQ(guard.step({.tip = tip, .desired = Vec3::Zero()}, sides).status, Status::free);
  const auto risen = mesh_of(moved(cube, Vec3(0.0, 0.0, 3.0)));
  guard.follow(risen, tree->refitted(risen));
  const Step out = guard.step({.tip = tip, .desired = Vec3(0.0, 0.0, -0.1)}, sides);
  EXPECT_EQ(out.status, Status::recovering);
  EXPECT_GT(out.motion.z(), 0.0);
}

TEST(MovingAnatomy, WatchesAskWhatTheGuardAsks) {
  const auto closed = mesh_of(make_cube(5.0));
  const auto open = mesh_of(opened(make_cube(5.0)));
  const Vec3 inside(0.3, 0.2, closed->bounds().high.z() - 2.0);
  for (const bool is_first_open : {true, false}) {
    const auto& first = is_first_open ? open : closed;
    const auto& then = is_first_open ? closed : open;
    MotionConstraint guard = guard_of(first, std::make_shared<WideBvh>(first));
    SideWatch sides;
    const Vec3 outside = inside + Vec3(0.0, 0.0, 5.0);
    static_cast<void>(guard.step({.tip = outside, .desired = Vec3::Zero()}, sides));
    guard.follow(then, std::make_shared<WideBvh>(then));
    const Step step = guard.step({.tip = inside, .desired = Vec3::Zero()}, sides);
    EXPECT_EQ(step.status, is_first_open ? Status::recovering : Status::free);
  }
}

TEST(MovingAnatomy, TheBudgetIsThatOfTheIndexThatIsFollowed) {
  const auto mesh = mesh_of("cortex");
  const auto tree = std::make_shared<WideBvh>(mesh);
  const auto slow = std::make_shared<PdTree>(mesh);
  const Vec3 far = mesh->bounds().center() + Vec3(1.0, 2.0, 3.0);
  const auto work_units = [&](MotionConstraint& guard) {
    static_cast<void>(guard.free_polytope(far, mesh->bounds().size().norm()));
    return guard.work_units();
  };
  MotionConstraint guard = make_motion_constraint(
      mesh, slow,
      {.options = {.radius = radius, .margin = margin}, .capacity = {.triangles = 1 << 20}});
  const std::size_t of_queries = work_units(guard);
  EXPECT_GT(of_queries, Capacity::work_units_of_traversals);
  guard.follow(mesh, tree);
  EXPECT_LE(work_units(guard), Capacity::work_units_of_traversals);
  guard.follow(mesh, slow);
  EXPECT_EQ(work_units(guard), of_queries);
}

TEST(MovingAnatomy, WhatCannotBeFollowedIsRefusedAndTheGuardGoesOn) {
  const auto mesh = mesh_of(make_cube(5.0));
  const auto tree = std::make_shared<WideBvh>(mesh);
  MotionConstraint guard = guard_of(mesh, tree);
  const auto risen = mesh_of(moved(make_cube(5.0), Vec3(0.0, 0.0, 3.0)));
  const auto huge = mesh_of(moved(make_cube(5.0), Vec3(0.0, 0.0, 1e20)));
  EXPECT_THROW(guard.follow(risen, tree), Error);
  EXPECT_THROW(guard.follow(nullptr, tree), Error);
  EXPECT_THROW(guard.follow(risen, nullptr), Error);
  EXPECT_THROW(guard.follow(huge, std::make_shared<WideBvh>(huge)), Error);
  EXPECT_THROW(tree->refitted(nullptr), Error);
  EXPECT_THROW(tree->refitted(mesh_of(make_cube(3.0))), Error);
  EXPECT_TRUE(guard.is_current());
  const Vec3 tip(0.3, 0.2, mesh->bounds().high.z() + 2.0);
  EXPECT_TRUE(guard.step({.tip = tip, .desired = Vec3(0.0, 0.0, -5.0)}).status != Status::free);
}

TEST(MovingAnatomy, AnotherMeshAltogetherMayBeFollowed) {
  const auto open = mesh_of(Surface{{{-50, -50, 0}, {50, -50, 0}, {0, 50, 0}}, {{0, 1, 2}}});
  MotionConstraint guard = guard_of(open, std::make_shared<WideBvh>(open));
  const auto closed = mesh_of(make_cube(5.0));
  guard.follow(closed, std::make_shared<WideBvh>(closed));
  const double top = closed->bounds().high.z();
  EXPECT_EQ(guard.step({.tip = Vec3(0.3, 0.2, top - 1.0), .desired = Vec3::Zero()}).status,
            Status::recovering);
  guard.follow(open, std::make_shared<WideBvh>(open));
  EXPECT_EQ(guard.step({.tip = Vec3(0.3, 0.2, -2.0), .desired = Vec3::Zero()}).status,
            Status::free);
}

}  // namespace
}  // namespace keepout::test::moving_anatomy
