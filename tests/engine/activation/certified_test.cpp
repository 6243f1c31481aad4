// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <gtest/gtest.h>

#include "keepout/activation/prepared_triangle.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/query.h"
#include "meshes.h"
#include "step/input.h"

namespace keepout {
namespace {

using Verdict = Judgement::Verdict;

/// A rule, prepared and opened as in a step.
class Scene {
 public:
  Scene(Surface surface, const StepOptions& options, std::size_t room = 100'000)
      : mesh(mesh_of(std::move(surface))),
        planes(100),
        turned(100),
        options_(options),
        near_(mesh, std::make_shared<BruteForce>(mesh), room, budget_) {
    rule.prepare(near_);
  }

  Opening open(const Vec3& tip, const Vec3& desired, EndRegion reach = EndRegion::target_ball) {
    input = rule_input_of({.tip = tip, .desired = desired}, options_, reach);
    planes.clear();
    if (!rule.gather(input)) return {Status::over_capacity};
    return rule.open(input, planes);
  }

  double tau() const { return rule.tolerance(input); }

  std::shared_ptr<const Mesh> mesh;
  CertifiedRule rule;
  RuleInput input;
  HalfSpaceBuffer planes;
  HalfSpaceBuffer turned;

 private:
  StepOptions options_;
  Budget budget_;
  Neighborhood near_;
};

constexpr StepOptions usual_options{.radius = 1.0, .margin = 0.2, .recovery = 0.05};

/// Returns a square at z = 0, free above.
Surface table() {
  return {{Vec3(-5, -5, 0), Vec3(5, -5, 0), Vec3(5, 5, 0), Vec3(-5, 5, 0)}, {{0, 1, 2}, {0, 2, 3}}};
}

Vec3 above(double height) { return {1.0, 0.5, height}; }

TEST(CertifiedRule, ItsToleranceIsThatOfTheSpecification) {
  Scene scene(table(), usual_options);
  const Vec3 far(1e3, -2e3, 0.3);
  scene.open(far, Vec3::Zero());
  const double longest = std::sqrt(200.0);
  EXPECT_NEAR(scene.tau(), 2e-10 * (longest + 1.0 + 0.2) + 4e-16 * 3000.3, 1e-16);
}

TEST(CertifiedRule, AtItsMarginATipIsClear) {
  Scene scene(table(), usual_options);
  for (const double height : {0.2, 0.3, 0.2 - 1e-12}) {
    const Opening opening = scene.open(above(height), Vec3(0, 0, -0.5));
    EXPECT_EQ(opening.status, Status::free) << height;
    EXPECT_TRUE(scene.planes.empty());
  }
}

TEST(CertifiedRule, AToleranceDecidesWhereTheMarginIsLost) {
  Scene scene(table(), usual_options);
  scene.open(above(1.0), Vec3::Zero());
  const double tau = scene.tau();
  EXPECT_EQ(scene.open(above(0.2 - 2.5 * tau), Vec3(0, 0, -0.5)).status, Status::free);
  EXPECT_EQ(scene.open(above(0.2 - 3.0 * tau), Vec3(0, 0, -0.5)).status, Status::recovering);
}

TEST(CertifiedRule, TooCloseItLeadsStraightAwayByTheRecovery) {
  Scene scene(table(), usual_options);
  const Opening opening = scene.open(above(0.1), Vec3::Zero());
  EXPECT_EQ(opening.status, Status::recovering);
  EXPECT_LT((opening.target - Vec3(0, 0, 0.05)).norm(), 1e-15);
  // The retreat ends at the margin.
  EXPECT_LT((scene.open(above(0.18), Vec3::Zero()).target - Vec3(0, 0, 0.02)).norm(), 1e-15);
}

TEST(CertifiedRule, TooCloseWhatLeadsAlongOrAwayIsKept) {
  Scene scene(table(), usual_options);
  const Vec3 down = scene.open(above(0.1), Vec3(0.3, -0.4, -0.5)).target;
  EXPECT_LT((down - Vec3(0.3, -0.4, 0.05)).norm(), 1e-15);
  const Vec3 up = scene.open(above(0.1), Vec3(0.3, -0.4, 0.5)).target;
  EXPECT_LT((up - Vec3(0.3, -0.4, 0.55)).norm(), 1e-15);
  Random random(1);
  for (int i = 0; i < 1'000; ++i) {
    const Vec3 target = scene.open(above(0.1), random.direction()).target;
    ASSERT_LE(target.norm(), 1.0 + 1e-8) << "beyond the motion sphere";
    ASSERT_GE(target.z(), 0.05 - 1e-12);
  }
}

TEST(CertifiedRule, OnTheSurfaceNoSideIsFree) {
  Scene scene(table(), usual_options);
  EXPECT_EQ(scene.open(above(0.0), Vec3(0, 0, 0.5)).status, Status::touching);
  const double tau = scene.tau();
  EXPECT_EQ(scene.open(above(3.0 * tau), Vec3(0, 0, 0.5)).status, Status::touching);
  EXPECT_EQ(scene.open(above(5.0 * tau), Vec3(0, 0, 0.5)).status, Status::recovering);
}

TEST(CertifiedRule, AMarginThatRoundingHidesIsRefused) {
  for (const double margin : {0.0, 1e-12, 5e-9}) {
    Scene scene(table(), {.radius = 1.0, .margin = margin});
    EXPECT_EQ(scene.open(above(1.0), Vec3(0, 0, -0.5)).status, Status::margin_too_small) << margin;
  }
  Scene scene(table(), {.radius = 1.0, .margin = 1e-7});
  EXPECT_EQ(scene.open(above(1.0), Vec3(0, 0, -0.5)).status, Status::free);
}

TEST(CertifiedRule, MoreTrianglesThanRoomIsAStatus) {
  Scene scene(table(), usual_options, 1);
  EXPECT_EQ(scene.open(Vec3(0, 0, 0.5), Vec3(0, 0, -0.5)).status, Status::over_capacity);
  EXPECT_EQ(scene.open(Vec3(0, 0, 0.5), Vec3(0, 0, 0.5)).status, Status::free);
}

TEST(CertifiedRule, LooksWhereMotionsMayLead) {
  Scene scene(table(), usual_options);
  const Vec3 tip = above(1.0), desired(0.2, -0.1, -0.6);
  scene.open(tip, desired);
  Random random(2);
  for (int i = 0; i < 1'000; ++i) {
    // A projection of the target onto a plane that allows zero motion.
    const Vec3 n = random.direction();
    const double offset = -random.uniform();
    const Vec3 motion = desired + std::max(offset - n.dot(desired), 0.0) * n;
    ASSERT_LE((tip + motion - scene.rule.region(scene.input).center).norm() + 0.2,
              scene.rule.region(scene.input).radius);
  }
  scene.open(tip, desired, EndRegion::motion_sphere);
  EXPECT_EQ(scene.rule.region(scene.input).center, tip);
  EXPECT_GE(scene.rule.region(scene.input).radius, 1.2);
}

TEST(CertifiedRule, WhatIsFreeIsAccepted) {
  Scene scene(table(), usual_options);
  scene.open(above(0.2), Vec3(0.5, 0.5, 0.0));
  EXPECT_EQ(scene.rule.judge(scene.input, Vec3(0.5, 0.5, 0.0), scene.planes).verdict,
            Verdict::accepted);
  EXPECT_TRUE(scene.planes.empty());
}

TEST(CertifiedRule, AnObjectionIsAPlaneThatExcludesTheTrialAndNotTheTip) {
  const Mesh mesh(make_shape("gear"));
  Scene scene(make_shape("gear"), usual_options);
  Random random(3);
  std::size_t objections = 0;
  for (const Vec3& tip : surface_points(mesh, 400, 0.25, random)) {
    const Vec3 trial = random.uniform(0.1, 1.0) * random.direction();
    if (scene.open(tip, trial).status != Status::free) continue;
    const Judgement judgement = scene.rule.judge(scene.input, trial, scene.planes);
    if (judgement.verdict == Verdict::accepted) continue;
    ASSERT_EQ(judgement.verdict, Verdict::objected);
    ++objections;
    ASSERT_EQ(scene.planes.size(), 1u);
    const HalfSpace plane = scene.planes[0];
    ASSERT_LT(plane.normal.dot(trial), plane.offset);
    ASSERT_LE(plane.offset, 3.0 * scene.tau());
    const PreparedTriangle prepared(mesh.triangle(plane.source), tip, plane.source);
    ASSERT_EQ(prepared.support(plane.normal) + 0.2, plane.offset);
    ASSERT_GE(judgement.free_fraction, 0.0);
    ASSERT_LE(judgement.free_fraction, 1.0);
    // The motion is free up to the contact.
    ASSERT_EQ(scene.rule.judge(scene.input, judgement.free_fraction * trial, scene.planes).verdict,
              Verdict::accepted);
  }
  EXPECT_GT(objections, 50u);
}

TEST(CertifiedRule, ATrialAgainstItsOwnPlaneIsBlocked) {
  Scene scene(table(), usual_options);
  const Vec3 trial(0.1, 0.0, -0.8);
  scene.open(Vec3(1.0, -3.0, 0.7), trial);
  EXPECT_EQ(scene.rule.judge(scene.input, trial, scene.planes).verdict, Verdict::objected);
  const std::size_t planes = scene.planes.size();
  const Judgement again = scene.rule.judge(scene.input, trial, scene.planes);
  EXPECT_EQ(again.verdict, Verdict::blocked);
  EXPECT_NEAR(again.free_fraction, 0.625, 1e-8);
  EXPECT_EQ(scene.planes.size(), planes);
}

TEST(CertifiedRule, StandingStillIsAlwaysAccepted) {
  for (const char* name : {"cortex", "needles", "triangle_soup", "fan", "thin_plates"}) {
    Scene scene(make_shape(name), usual_options);
    Random random(4);
    for (const Vec3& tip : surface_points(*scene.mesh, 30, random.uniform(0.01, 0.5), random)) {
      const Opening opening = scene.open(tip, random.direction());
      if (opening.status == Status::touching) continue;
      ASSERT_EQ(scene.rule.judge(scene.input, Vec3::Zero(), scene.planes).verdict,
                Verdict::accepted)
          << name << " " << tip.transpose();
    }
  }
}

TEST(CertifiedRule, OnlyOffsetsThatAskForMotionAreRelaxed) {
  CertifiedRule rule;
  HalfSpaceBuffer planes(3);
  planes.push({Vec3::UnitZ(), -0.5, 0});
  planes.push({Vec3::UnitX(), 0.0, 1});
  EXPECT_FALSE(rule.relax(planes));
  planes.push({Vec3::UnitY(), 1e-9, 1});
  EXPECT_TRUE(rule.relax(planes));
  EXPECT_EQ(planes[0].offset, -0.5);
  EXPECT_EQ(planes[2].offset, 0.0);
  EXPECT_FALSE(rule.relax(planes));
}

TEST(CertifiedRule, TurnedPlanesAllowTheTipAndTheMotionAsBefore) {
  for (const char* name : {"sphere", "gear", "cortex", "saddle_terrain", "star_bumps"}) {
    const Mesh mesh(make_shape(name));
    Scene scene(make_shape(name), usual_options);
    Random random(5);
    std::size_t changed = 0;
    for (const Vec3& tip : surface_points(mesh, 150, 0.25, random)) {
      const Vec3 trial = random.uniform(0.2, 1.0) * random.direction();
      if (scene.open(tip, trial).status != Status::free) continue;
      const Judgement judgement = scene.rule.judge(scene.input, trial, scene.planes);
      if (judgement.verdict != Verdict::objected) continue;
      const HalfSpace old = scene.planes[0];
      // A motion along the plane, as a solver would return.
      const Vec3 accepted = trial + (old.offset - old.normal.dot(trial)) * old.normal;
      scene.turned.clear();
      scene.input.accepted = accepted;
      if (!scene.rule.relinearize(scene.input, scene.planes.view(), scene.turned)) continue;
      ++changed;
      ASSERT_EQ(scene.turned.size(), 1u);
      const HalfSpace plane = scene.turned[0];
      const double slack = 0.1 * scene.tau();
      ASSERT_EQ(plane.source, old.source);
      ASSERT_NEAR(plane.normal.norm(), 1.0, 1e-15);
      ASSERT_LE(plane.offset, std::max(old.offset, 0.0) + slack) << "the tip may stay";
      ASSERT_GE(plane.normal.dot(accepted), plane.offset - slack) << "the motion is allowed";
      const PreparedTriangle prepared(mesh.triangle(plane.source), tip, plane.source);
      ASSERT_NEAR(prepared.support(plane.normal) + 0.2, plane.offset, 1e-14)
          << "the prepared triangle is behind";
    }
    EXPECT_GT(changed, 10u) << name;
  }
}

TEST(CertifiedRule, IdlePlanesAreDroppedByATurn) {
  Scene scene(table(), usual_options);
  const Vec3 target(0.5, 0.0, -0.6);
  scene.open(Vec3(1.0, -3.0, 0.7), target);
  scene.planes.push({Vec3::UnitZ(), -0.5, 0});
  scene.turned.clear();
  scene.input.accepted = Vec3(0.5, 0.0, 0.2);
  EXPECT_FALSE(scene.rule.relinearize(scene.input, scene.planes.view(), scene.turned));
  EXPECT_TRUE(scene.turned.empty());
}

}  // namespace
}  // namespace keepout
