// SPDX-License-Identifier: BSD-3-Clause
// Step::limits names exactly the causes that make a motion differ from the desired one.

#include <array>
#include <optional>

#include "accuracy/certified_loop.h"

namespace keepout::test::step_limits {
namespace {

/// A random motion near a shape, with or without guides, rows and joints.
struct Question {
  Vec3 tip;
  Vec3 desired;
  std::optional<Eigen::Matrix3d> jacobian = std::nullopt;
  std::array<double, 6> rows{};
  std::array<double, 2> bounds{};
  std::size_t row_count = 0;
  std::vector<Guide> guides;

  Motion motion() const {
    Motion motion{.tip = tip, .desired = desired};
    if (jacobian) motion.jacobian.emplace(*jacobian);
    if (row_count > 0) {
      motion.rows.emplace(rows.data(), bounds.data(), static_cast<Eigen::Index>(row_count));
    }
    return motion;
  }
};

Question random_question(const Vec3& tip, Random& random) {
  Question q;
  q.tip = tip;
  q.desired = random.uniform(0.0, 2.0) * random.direction();
  if (random.below(4) == 0) {
    q.jacobian.emplace();
    for (int c = 0; c < 3; ++c) q.jacobian->col(c) = random.uniform(0.3, 2.0) * random.direction();
  }
  if (random.below(3) == 0) {
    q.row_count = 1 + random.below(2);
    for (double& number : q.rows) number = random.uniform(-1.0, 1.0);
    for (double& bound : q.bounds) bound = random.uniform(-0.5, 1.0);
  }
  for (std::size_t g = random.below(4); g-- > 1;) {
    const double radius = random.uniform(0.3, 2.0);
    const Vec3 center = tip + (radius + random.uniform(-0.6, 0.1)) * random.direction();
    q.guides.push_back(Guide::point("ball", Region::ball(center, radius)));
  }
  return q;
}

/// Returns the distance between the commanded and the executed motion. [length]
double missed(const Question& q, const Step& step) { return (step.motion - q.desired).norm(); }

class StepLimits : public testing::Test {
 protected:
  std::shared_ptr<const Mesh> mesh_ = mesh_of("gear");
  MotionConstraintSettings settings_{.options = {.radius = 2.0, .tool_radius = 0.5, .margin = 0.2}};
  MotionConstraint guard_ = make_motion_constraint(mesh_, settings_);
  // Its mesh is out of reach, for steps that no mesh limits.
  MotionConstraint bare_ = make_motion_constraint(
      mesh_of(Surface{{{1e6, 0, 0}, {1e6, 1, 0}, {1e6, 0, 1}}, {{0, 1, 2}}}), settings_);
};

TEST_F(StepLimits, NameACauseThatChangesTheMotionWhenItIsTakenAway) {
  // With --gtest_shuffle --gtest_repeat=50, each repetition draws other motions.
  Random random(5u + static_cast<unsigned>(testing::UnitTest::GetInstance()->random_seed()));
  std::array<int, limit_count> seen{};
  const int count = trials(60'000);
  const std::vector<Vec3> tips =
      surface_points(*mesh_, static_cast<std::size_t>(count), 1.2, random);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    Question q = random_question(tips[static_cast<std::size_t>(i)], random);
    guard_.set_guides(q.guides);
    guard_.forget();
    const Step step = guard_.step(q.motion());
    const Vec3 motion = step.motion;
    const Limits limits = step.limits;
    if (!step.ok()) {
      const bool has_cause =
          step.status != Status::ill_posed && step.status != Status::beyond_reach;
      ASSERT_EQ(has_cause, !limits.empty()) << name(step.status);
      ASSERT_TRUE(step.status != Status::ill_posed || q.jacobian);
      ASSERT_EQ(limits.has(Limit::guide), std::ranges::any_of(step.guides, &GuideState::limits));
      continue;
    }
    ASSERT_FALSE(step.status == Status::limited && limits.empty());
    if (step.status == Status::free) {
      ASSERT_TRUE(limits.empty());
      ASSERT_LE(missed(q, step), 1e-9);
    }
    if (step.status != Status::recovering) {
      ASSERT_EQ(step.status == Status::truncated, limits.has(Limit::truncated));
    }
    ASSERT_EQ(limits.has(Limit::guide), std::ranges::any_of(step.guides, &GuideState::limits));
    for (std::size_t l = 0; l < limit_count; ++l) {
      if (limits.has(static_cast<Limit>(l))) ++seen[l];
    }
    if (step.status != Status::limited) continue;
    if (limits.has(Limit::mesh)) {
      bare_.set_guides(q.guides);
      ASSERT_NE(bare_.step(q.motion()).motion, motion);
    }
    if (limits.has(Limit::guide)) {
      guard_.set_guides({});
      ASSERT_NE(guard_.step(q.motion()).motion, motion);
      guard_.set_guides(q.guides);
    }
    if (limits.has(Limit::rows)) {
      q.row_count = 0;
      ASSERT_NE(guard_.step(q.motion()).motion, motion);
    }
  }
  for (const Limit limit : {Limit::mesh, Limit::guide, Limit::rows, Limit::radius}) {
    EXPECT_GT(seen[static_cast<std::size_t>(limit)], trials(20)) << name(limit);
  }
}

TEST_F(StepLimits, NameASpentBudgetAndASmallStore) {
  Random random(4);
  settings_.inside = Inside::taken_as_is;
  const std::vector<Vec3> tips = surface_points(*mesh_, 200, 0.6, random);
  const auto ends_in = [&](Status status, Limit limit) {
    MotionConstraint guard = make_motion_constraint(mesh_, settings_);
    int count = 0;
    for (const Vec3& tip : tips) {
      const Step step = guard.step({.tip = tip, .desired = -tip.normalized()});
      EXPECT_TRUE(step.ok() || step.limits.has(limit)) << name(step.status);
      count += step.status == status ? 1 : 0;
    }
    return count;
  };
  settings_.capacity.work_units = 1;
  EXPECT_GT(ends_in(Status::out_of_budget, Limit::budget), 20);
  settings_.capacity = {.triangles = 1, .planes = 1};
  settings_.index = "pd_tree";
  EXPECT_GT(ends_in(Status::over_capacity, Limit::capacity), 20);
}

// The Jacobian can move the tip along x only.
TEST_F(StepLimits, NameAJacobianThatCannotMakeTheMotion) {
  const Eigen::Matrix<double, 3, 1> jacobian(1, 0, 0);
  const Vec3 tip(0, 0, 0);
  const Step across = bare_.step({.tip = tip, .desired = Vec3(0, 1, 0), .jacobian = jacobian});
  EXPECT_EQ(across.status, Status::limited);
  EXPECT_TRUE(across.limits.has(Limit::singularity));
  const Step along = bare_.step({.tip = tip, .desired = Vec3(1, 0, 0), .jacobian = jacobian});
  EXPECT_EQ(along.status, Status::free);
  // A retreat that the joints can make differs from the commanded motion, without a singularity.
  Random random(6);
  const Mat3 identity = Mat3::Identity();
  int retreats = 0;
  for (const Vec3& near : surface_points(*mesh_, 200, 0.6, random)) {
    const Step step =
        guard_.step({.tip = near, .desired = -near.normalized(), .jacobian = identity});
    EXPECT_FALSE(step.limits.has(Limit::singularity));
    retreats += step.status == Status::recovering ? 1 : 0;
  }
  EXPECT_GT(retreats, 20);
}

// The tip is outside of a tube and of a ball. With a slab, these are so nearly infeasible that no
// solver converges. Zero motion satisfies all of them.
TEST_F(StepLimits, OfGuidesThatLeaveNoMotionAreTheGuides) {
  bare_.set_guides(
      {Guide::point("a", Region::tube({0.239078528, -0.0644965669, -0.0039728495},
                                      {-0.2604602, -0.965484585, 0}, 0.0363233829)),
       Guide::point("b", Region::slab({3.85762497, -3.4440309, -1.75609281},
                                      {-0.706348446, 0.630617516, 0.321548475}, 6.5717728)),
       Guide::point("c", Region::ball({-2.99761064, 1.66156104, 5.67051919}, 0.041010171))});
  const Step step = bare_.step(
      {.tip = {0.2022521542764141, 0.19545175029569609, 0.16873159792513653},
       .desired = {-0.00048572789346622947, 0.00049591118817117518, 0.00082904879045340031}});
  ASSERT_TRUE(step.ok()) << name(step.status);
  EXPECT_TRUE(step.limits.has(Limit::guide));
  EXPECT_FALSE(step.limits.has(Limit::mesh));
  EXPECT_TRUE(std::ranges::any_of(step.guides, &GuideState::limits));
}

TEST_F(StepLimits, SayOfATruncatedRecoveryThatItIsOne) {
  settings_.capacity.triangles = 8;
  settings_.index = "pd_tree";
  settings_.inside = Inside::taken_as_is;
  MotionConstraint narrow = make_motion_constraint(mesh_, settings_);
  Random random(6);
  int recoveries = 0;
  int truncated = 0;
  std::vector<Vec3> tips = surface_points(*mesh_, 3'000, 0.65, random);
  const std::vector<Vec3> farther = surface_points(*mesh_, 3'000, 1.2, random);
  tips.insert(tips.end(), farther.begin(), farther.end());
  for (const Vec3& tip : tips) {
    const Step step = narrow.step({.tip = tip, .desired = 1.9 * random.direction()});
    if (!step.ok() || !step.limits.has(Limit::truncated)) continue;
    ASSERT_TRUE(step.limits.has(Limit::capacity) || step.limits.has(Limit::mesh));
    recoveries += step.status == Status::recovering ? 1 : 0;
    truncated += step.status == Status::truncated ? 1 : 0;
  }
  EXPECT_GT(recoveries, 10);
  EXPECT_GT(truncated, 10);
}

}  // namespace
}  // namespace keepout::test::step_limits
