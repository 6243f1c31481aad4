// SPDX-License-Identifier: BSD-3-Clause
// The force, its energy and its passivity, without a mesh.

#include <Eigen/Geometry>
#include <cmath>

#include "keepout/control/haptic_force.h"
#include "keepout/error.h"
#include "trials.h"

namespace keepout::test::force {
namespace {

TEST(SpringDamper, TheForceIsTheStiffnessTimesTheStretchAndSaturates) {
  const SpringDamper spring{.stiffness = 2.0, .largest_force = 5.0};
  EXPECT_EQ(spring.force(0.0, 0.0), 0.0);
  EXPECT_EQ(spring.force(1.5, 0.0), 3.0);
  EXPECT_EQ(spring.force(2.5, 0.0), 5.0);
  EXPECT_EQ(spring.force(100.0, 0.0), 5.0);
}

TEST(SpringDamper, TheDamperResistsBothWaysButNeverPullsTowardsTheSurface) {
  const SpringDamper spring{.stiffness = 2.0, .damping = 0.1, .largest_force = 5.0};
  EXPECT_DOUBLE_EQ(spring.force(1.0, 5.0), 2.5);
  EXPECT_DOUBLE_EQ(spring.force(1.0, -5.0), 1.5);
  EXPECT_EQ(spring.force(1.0, -50.0), 0.0);
  EXPECT_EQ(spring.force(1.0, 500.0), 5.0);
}

TEST(SpringDamper, WhatIsStoredIsTheIntegralOfTheForce) {
  const SpringDamper spring{.stiffness = 3.0, .largest_force = 4.0};
  double integral = 0.0;
  constexpr double step = 1e-4;
  for (int i = 0; i < 30'000; ++i) {
    EXPECT_NEAR(spring.stored(i * step), integral, 1e-6);
    integral += spring.spring_force((i + 0.5) * step) * step;
  }
}

TEST(SpringDamper, NumbersOutOfRangeAreRefused) {
  EXPECT_NO_THROW(check(SpringDamper{}));
  for (const double bad : {0.0, -1.0, test::nan, 1e10}) {
    EXPECT_THROW(check(SpringDamper{.stiffness = bad}), Error);
    EXPECT_THROW(check(SpringDamper{.largest_force = bad}), Error);
  }
  for (const double bad : {-1.0, test::nan, 1e10}) EXPECT_THROW(check({.damping = bad}), Error);
  for (const double bad : {0.0, test::nan}) EXPECT_THROW(check({.largest_rise = bad}), Error);
}

TEST(PassivityObserver, CountsWhatTheHandPutsInLessWhatItGets) {
  PassivityObserver observer(1.0);
  observer.observe({0, 0, 2}, {0, 0, -3});  // the operator pushes against the force
  EXPECT_EQ(observer.energy(), 6.0);
  EXPECT_EQ(observer.brake({0, 0, 1}, 0.001), Vec3::Zero());
  observer.observe({0, 0, 4}, {0, 0, 2});
  EXPECT_EQ(observer.energy(), -2.0);
}

TEST(PassivityObserver, BrakesSoThatTheDebtIsPaidInOneCycle) {
  PassivityObserver observer(1e9);
  observer.observe({0, 0, 4}, {0, 0, 0.5});
  const Vec3 way(0.1, 0.0, 0.2);
  const Vec3 brake = observer.brake(way, 0.001);
  EXPECT_LT(brake.dot(way), 0.0);
  EXPECT_LT(brake.normalized().cross(way.normalized()).norm(), 1e-15);
  observer.observe(brake, way);
  EXPECT_NEAR(observer.energy(), 0.0, 1e-12);
}

TEST(PassivityObserver, BrakesNoHarderThanItMayAndNotAtRest) {
  PassivityObserver observer(0.01);
  observer.observe({0, 0, 4}, {0, 0, 0.5});
  EXPECT_NEAR(observer.brake({0, 0, 0.2}, 0.001).z(), -0.01 * 0.2 / 0.001, 1e-12);
  EXPECT_EQ(observer.brake(Vec3::Zero(), 0.001), Vec3::Zero());
  EXPECT_EQ(PassivityObserver().brake({0, 0, 0.2}, 0.001), Vec3::Zero());
  // The square of these displacements underflows. The brake must stay bounded.
  EXPECT_TRUE(observer.brake({0, 0, 1e-170}, 0.001).allFinite());
}

TEST(PassivityObserver, OnLeavingContactDebtsStayAndSurplusGoes) {
  PassivityObserver observer;
  observer.observe({0, 0, 1}, {0, 0, -1});
  observer.leave_contact();
  EXPECT_EQ(observer.energy(), 0.0);
  observer.observe({0, 0, 1}, {0, 0, 1});
  observer.leave_contact();
  EXPECT_EQ(observer.energy(), -1.0);
}

/// A mass that falls on a wall at 0. A sampled spring without friction repels it.
struct Fall {
  double period = 0.01;  // of the display [s]
  SpringDamper spring{.stiffness = 2.0, .largest_force = 1e3};
  double largest_brake = 0.0;
  double mass = 2e-4;  // [N s^2 / mm]: 0.2 kg

  /// Returns the energy of the mass after `cycles` cycles, divided by its energy at the start.
  double energy_gain(int cycles, EnergyReport* report = nullptr) const {
    PassivityObserver observer(largest_brake);
    EnergyReport account;
    HeldForce held;
    double x = 0.0, v = -50.0, seen = 0.0;
    constexpr int substeps = 200;
    for (int cycle = 0; cycle < cycles; ++cycle) {
      const Vec3 way(0, 0, x - seen);
      observer.observe(held.total(), way);
      const double stretch = std::max(0.0, -x);
      account.book(held, way, Vec3(0, 0, std::max(x, 0.0) - std::max(seen, 0.0)),
                   spring.stored(stretch));
      account.active = std::max(account.active, -observer.energy());
      seen = x;
      held = {};
      if (stretch > 0.0) {
        held.spring = Vec3(0, 0, spring.force(stretch, 0.0));
        held.brake = observer.brake(way, period);
      } else {
        observer.leave_contact();
      }
      // Without gravity the mass would fly away, so a perfect wall at 5 reflects it.
      if (x > 5.0 && v > 0.0) v = -v;
      for (int i = 0; i < substeps; ++i) {
        v += held.total().z() / mass * period / substeps;
        x += v * period / substeps;
      }
    }
    if (report != nullptr) *report = account;
    return (0.5 * mass * v * v + spring.stored(std::max(0.0, -x))) / (0.5 * mass * 50.0 * 50.0);
  }
};

TEST(Passivity, AStiffSpringInASlowLoopIsActiveAndIsSeenToBe) {
  EnergyReport report;
  EXPECT_GT(Fall().energy_gain(400, &report), 10.0);
  EXPECT_GT(report.active, 0.25);  // the initial energy of the mass
  EXPECT_GT(report.to_hand, 0.25);
  EXPECT_LT(report.dissipated, 0.0);
}

TEST(Passivity, TheControllerBrakesItSoThatNoEnergyIsGained) {
  EnergyReport report;
  EXPECT_LT(Fall{.largest_brake = 0.04}.energy_gain(400, &report), 1.1);
  EXPECT_GT(report.braked, 0.0);
}

TEST(Passivity, AFastLoopOfAsoftSpringIsAllButPassive) {
  EnergyReport report;
  const Fall fall{.period = 1e-4, .spring = {.stiffness = 0.5, .largest_force = 1e3}};
  EXPECT_LT(fall.energy_gain(40'000, &report), 1.5);
}

TEST(Passivity, TheEnergiesAddUpToRounding) {
  EnergyReport report;
  for (const double brake : {0.0, 0.04}) {
    Fall{.largest_brake = brake}.energy_gain(1000, &report);
    EXPECT_NEAR(report.to_hand + report.stored + report.dissipated, report.from_proxy,
                1e-12 * (std::abs(report.to_hand) + std::abs(report.dissipated) + 1.0));
  }
}

}  // namespace
}  // namespace keepout::test::force
