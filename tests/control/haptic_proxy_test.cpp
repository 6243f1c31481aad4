// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/haptic_proxy.h"

#include "control/guarded_shapes.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::haptic_proxy {
namespace {
constexpr double accuracy = 1e-6;  // of a limited step [mm]

/// Moves the operator's hand straight and slowly; returns the last cycle.
HapticCycle lead(HapticProxy& proxy, const Vec3& from, const Vec3& to, int cycles) {
  HapticCycle cycle;
  for (int i = 1; i <= cycles; ++i) {
    cycle = proxy.cycle(from + (static_cast<double>(i) / cycles) * (to - from));
  }
  return cycle;
}

void expect_balance(const EnergyReport& report) {
  EXPECT_NEAR(report.to_hand + report.stored + report.dissipated, report.from_proxy,
              1e-12 * (std::abs(report.to_hand) + std::abs(report.from_proxy) +
                       std::abs(report.dissipated) + 1.0));
}

const Vec3 above(3.0, 4.0, top + 5.0);

/// Returns a proxy above the cube.
HapticProxy engaged(const HapticOptions& options = {}) {
  HapticProxy proxy(guard_of(cube()), options);
  EXPECT_EQ(proxy.engage(above), CycleStatus::guarded);
  return proxy;
}

TEST(HapticProxy, FollowsTheHandExactlyAndWithoutForceInFreeSpace) {
  HapticProxy proxy = engaged();
  Random random(1);
  Vec3 hand = above;
  for (int i = 0; i < 1000; ++i) {
    hand += 0.05 * random.direction();
    hand.z() = std::max(hand.z(), top + 2.0);
    const HapticCycle cycle = proxy.cycle(hand);
    ASSERT_TRUE(cycle.ok());
    EXPECT_EQ(cycle.proxy, hand);
    EXPECT_EQ(cycle.force, Vec3::Zero());
  }
  EXPECT_EQ(proxy.energy().to_hand, 0.0);
  EXPECT_EQ(proxy.energy().active, 0.0);
}

// In a corridor beside the cube. The operator feels the wall of the corridor like the mesh.
TEST(HapticProxy, StaysInItsGuidesAndPullsTheHandBackIntoThem) {
  const SpringDamper spring{.stiffness = 0.7, .damping = 0.002, .largest_force = 4.0};
  HapticOptions options{.spring = spring};
  options.guides = {Guide::point("corridor", Region::slab(above, Vec3::UnitX(), 1.0))};
  HapticProxy proxy = engaged(options);
  const Vec3 aside = above + Vec3(3.0, 0.5, 0.0);
  lead(proxy, above, aside, 200);
  const HapticCycle cycle = proxy.cycle(aside);  // at rest
  EXPECT_LE(cycle.proxy.x(), above.x() + 1.0 + options.guides[0].band());
  EXPECT_NEAR(cycle.proxy.y(), above.y() + 0.5, accuracy) << "along the corridor it follows";
  EXPECT_TRUE(proxy.guides()[0].limits);
  EXPECT_NEAR(cycle.force.x(), -0.7 * 2.0, 0.01);
  options.guides.assign(Guide::most + 1, options.guides[0]);
  EXPECT_THROW(HapticProxy(guard_of(cube()), options), Error);
}

TEST(HapticProxy, OnAPlaneTheStaticForceIsTheStiffnessTimesTheDepthBehindTheMargin) {
  const SpringDamper spring{.stiffness = 0.7, .damping = 0.002, .largest_force = 4.0};
  HapticProxy proxy = engaged({.spring = spring});
  for (const double depth : {0.1, 1.0, 4.0}) {
    const Vec3 hand(3.0, 4.0, top + kept - depth);
    lead(proxy, above, hand, 200);
    HapticCycle cycle;
    for (int i = 0; i < 100; ++i) cycle = proxy.cycle(hand);
    EXPECT_EQ(cycle.status, CycleStatus::guarded);
    EXPECT_EQ(cycle.step, Status::limited);
    EXPECT_LT((cycle.proxy - Vec3(3.0, 4.0, top + kept)).norm(), accuracy);
    EXPECT_LT((cycle.force - Vec3(0, 0, 0.7 * depth)).norm(), accuracy);
    lead(proxy, hand, above, 200);
  }
}

TEST(HapticProxy, OnASphereTheForceIsRadialAndTheStiffnessTimesTheDepth) {
  HapticProxy proxy(guard_of(mesh_of(make_sphere(2.0))), {});
  const Vec3 outwards = Vec3(1, 2, 3).normalized();
  proxy.engage(56.0 * outwards);
  const Vec3 hand = 48.0 * outwards;
  lead(proxy, 56.0 * outwards, hand, 300);
  HapticCycle cycle;
  for (int i = 0; i < 300; ++i) cycle = proxy.cycle(hand);
  // The polyhedron lies inside the sphere by about 1/100, and its triangles are tilted by about
  // 1/50.
  EXPECT_NEAR(cycle.proxy.norm(), 50.0 + kept, 0.05);
  EXPECT_NEAR(cycle.force.norm(), 2.5, 0.05);
  EXPECT_GT(cycle.force.normalized().dot(outwards), 0.999);
  EXPECT_LT((cycle.force - (cycle.proxy - hand)).norm(), 1e-12);
}

TEST(HapticProxy, TheForceSaturatesAndKeepsItsDirection) {
  HapticProxy proxy = engaged({.spring = {.stiffness = 1.0, .largest_force = 2.0}});
  const Vec3 deep(3.0, 4.0, top - 20.0);
  const HapticCycle cycle = lead(proxy, above, deep, 500);
  EXPECT_LT((cycle.force - Vec3(0, 0, 2.0)).norm(), 1e-9);
  EXPECT_LE(proxy.energy().largest_force, 2.0 * (1.0 + 1e-15));
}

TEST(HapticProxy, TheProxyStaysOutWhateverTheHandDoes) {
  HapticProxy proxy =
      engaged({.spring = {.stiffness = 3.0, .damping = 0.01}, .largest_brake = 0.01});
  Random random(2);
  Vec3 hand = above;
  for (int i = 0; i < 20'000; ++i) {
    if (i % 50 == 0) hand = 45.0 * random.direction() + Vec3(0, 0, 20);
    if (i % 997 == 0) hand.x() = test::nan;
    const Vec3 before = proxy.proxy();
    const HapticCycle cycle = proxy.cycle(hand);
    const Vec3 past = cycle.proxy.cwiseAbs() - Vec3::Constant(top);
    const double distance =
        past.maxCoeff() > 0.0 ? past.cwiseMax(Vec3::Zero()).norm() : past.maxCoeff();
    ASSERT_GT(distance, kept - accuracy) << i;
    ASSERT_TRUE(cycle.force.allFinite());
    ASSERT_LE(cycle.force.norm(), 4.0 * (1.0 + 1e-12));
    ASSERT_LE((cycle.proxy - before).norm(), 0.2 * (1.0 + 1e-9)) << "200 mm/s at 1 kHz";
    if (!cycle.ok()) {
      ASSERT_EQ(cycle.proxy, before);
    }
  }
  expect_balance(proxy.energy());
  EXPECT_GT(proxy.energy().blind_cycles, 0u);
}

TEST(HapticProxy, TheEnergiesAddUpAndASlowPressIsElastic) {
  HapticProxy proxy = engaged({.spring = {.stiffness = 1.0, .largest_force = 2.0}});
  const Vec3 deep(3.0, 4.0, top + kept - 3.0);
  lead(proxy, above, deep, 20'000);
  // The spring stores 2 N mm over its first 2 mm, and 2 N mm over 1 mm at its largest force.
  EXPECT_NEAR(proxy.energy().stored, 2.0 + 2.0, 1e-5);
  EXPECT_NEAR(proxy.energy().to_hand, -4.0, 1e-3);
  expect_balance(proxy.energy());
  lead(proxy, deep, above, 20'000);
  EXPECT_EQ(proxy.energy().stored, 0.0);
  EXPECT_NEAR(proxy.energy().to_hand, 0.0, 2e-3);
  EXPECT_NEAR(proxy.energy().from_proxy, 0.0, 1e-4) << "a wall that stands still does no work";
  expect_balance(proxy.energy());
}

TEST(HapticProxy, ADamperTakesWhatTheTheorySays) {
  constexpr double damping = 0.02, speed = 10.0, depth = 2.0;
  HapticProxy proxy(guard_of(cube()),
                    {.spring = {.stiffness = 1.0, .damping = damping, .largest_force = 100.0}});
  proxy.engage(Vec3(3, 4, top + kept));
  const Vec3 start(3, 4, top + kept), deep(3, 4, top + kept - depth);
  const int cycles = static_cast<int>(depth / speed / 0.001);
  lead(proxy, start, deep, cycles);
  lead(proxy, deep, start, cycles);
  // The integral of damping v^2, there and back. Less (b v)^2 / 2k, because the damper does not
  // pull on leaving. Less k v T depth, which a late force returns.
  const double force = damping * speed;
  const double expected = 2.0 * force * depth - 0.5 * force * force - speed * 0.001 * depth;
  EXPECT_NEAR(proxy.energy().dissipated, expected, 0.03 * expected);
  EXPECT_EQ(proxy.energy().active, 0.0);
}

TEST(HapticProxy, SlidingDoesNoWork) {
  HapticProxy proxy(guard_of(cube()), {});
  const Vec3 start(-20, 4, top + kept + 0.2), pressed(-20, 4, top + kept - 1.0);
  proxy.engage(start);
  lead(proxy, start, pressed, 2000);
  const double before = proxy.energy().to_hand;
  lead(proxy, pressed, pressed + Vec3(40, 0, 0), 2000);
  // The force is constant for a cycle while the hand moves on. Only this does work.
  EXPECT_NEAR(proxy.energy().to_hand, before, 1e-6) << "nothing of 1 N over 40 mm";
}

TEST(HapticProxy, WithoutAHandTheProxyStandsAndTheForceFadesWithoutAJump) {
  HapticProxy proxy = engaged({.fade = 0.05});
  const Vec3 hand(3.0, 4.0, top + kept - 2.0);
  const HapticCycle pressed = lead(proxy, above, hand, 200);
  ASSERT_NEAR(pressed.force.z(), 2.0, accuracy);
  double before = pressed.force.z();
  for (int i = 1; i <= 60; ++i) {
    const HapticCycle cycle = proxy.cycle({test::nan, 0.0, 0.0});
    EXPECT_EQ(cycle.status, CycleStatus::invalid_pose);
    EXPECT_EQ(cycle.proxy, pressed.proxy);
    EXPECT_LE(before - cycle.force.z(), 2.0 / 50.0 + accuracy);
    EXPECT_NEAR(cycle.force.z(), std::max(0.0, 2.0 * (1.0 - i / 50.0)), accuracy);
    before = cycle.force.z();
  }
  EXPECT_LT(before, 1e-12);
  // The force returns as slowly.
  for (int i = 1; i <= 60; ++i) {
    const HapticCycle cycle = proxy.cycle(hand);
    EXPECT_EQ(cycle.status, CycleStatus::guarded);
    EXPECT_NEAR(cycle.force.z(), std::min(2.0, 2.0 * i / 50.0), accuracy);
  }
  EXPECT_EQ(proxy.energy().blind_cycles, 61u);
  expect_balance(proxy.energy());
}

TEST(HapticProxy, WhenTheEngineRefusesTheProxyStandsAndTheForceFadesWithTheHand) {
  // Deep inside, where the engine starts no escape.
  HapticProxy proxy(guard_of(cube()), {.fade = 0.02});
  proxy.engage(Vec3::Zero());
  for (int i = 1; i <= 30; ++i) {
    const HapticCycle cycle = proxy.cycle({0.1 * i, 0, 0});
    EXPECT_EQ(cycle.status, CycleStatus::stopped);
    EXPECT_EQ(cycle.step, Status::inside);
    EXPECT_EQ(cycle.reason(), reason(Status::inside, Subject::tip));
    EXPECT_EQ(cycle.proxy, Vec3::Zero());
    EXPECT_NEAR(cycle.force.x(), -0.1 * i * std::max(0.0, 1.0 - i / 20.0), 1e-12);
  }
  expect_balance(proxy.energy());
}

TEST(HapticProxy, StandsOnceItsMeshHasMoved) {
  const auto tree = std::make_shared<WideBvh>(cube());
  HapticProxy proxy(make_motion_constraint(cube(), tree, {.options = {.margin = kept}}), {});
  proxy.engage(above);
  EXPECT_EQ(proxy.cycle(above + Vec3(0.1, 0, 0)).status, CycleStatus::guarded);
  const Vec3 before = proxy.proxy();
  tree->refit(mesh_of(moved(make_cube(10.0), Vec3::UnitZ())));
  const HapticCycle cycle = proxy.cycle(above);
  EXPECT_EQ(cycle.status, CycleStatus::stopped);
  EXPECT_EQ(cycle.step, Status::mesh_changed);
  EXPECT_EQ(cycle.proxy, before);
}

TEST(HapticProxy, AHandOutOfReachIsTakenForAFault) {
  HapticProxy proxy = engaged({.farthest = 30.0});
  EXPECT_EQ(proxy.cycle(above + Vec3(0, 0, 29.0)).status, CycleStatus::guarded);
  const Vec3 before = proxy.proxy();
  for (const double far : {40.0, 1e6, 1e29, 1e200}) {
    EXPECT_FALSE(proxy.cycle(above + Vec3(0, 0, far)).ok());
    EXPECT_EQ(proxy.proxy(), before);
  }
  EXPECT_EQ(proxy.cycle(above + Vec3(0, 0, 40.0)).status, CycleStatus::too_far);
}

TEST(HapticProxy, AProxyThatMayNotGoFasterPullsTheHandBack) {
  HapticProxy proxy = engaged({.top_speed = 100.0});
  const HapticCycle cycle = proxy.cycle(above + Vec3(0, 0, 1.1));
  EXPECT_NEAR((cycle.proxy - above).z(), 0.1, 1e-12);
  EXPECT_NEAR(cycle.force.z(), -1.0, 1e-12);
}

TEST(HapticProxy, ATipThatIsLedOffGoesNoFasterThanTheTopSpeed) {
  for (const double recovery : {0.05, 2.0}) {
    for (const double start : {top + 0.1, top, top - 3.0}) {
      HapticProxy proxy(guard_of(cube(), {.options = {.margin = kept, .recovery = recovery}}),
                        {.top_speed = 50.0});
      proxy.engage(Vec3(3, 4, start));
      for (int i = 0; i < 200; ++i) {
        const Vec3 before = proxy.proxy();
        const HapticCycle cycle = proxy.cycle(Vec3(13, 4, top + 2.0));
        ASSERT_TRUE(cycle.ok());
        ASSERT_LE((cycle.proxy - before).norm(), 0.05 * (1.0 + 1e-9)) << recovery << ' ' << start;
      }
      EXPECT_GT(proxy.proxy().z(), top + kept - accuracy);
    }
  }
}

TEST(HapticProxy, TheForceRisesNoFasterThanItMay) {
  HapticProxy proxy(guard_of(cube()), {.spring = {.largest_rise = 20.0}});
  proxy.engage(Vec3(3, 4, top + kept));
  const Vec3 hand(3, 4, top + kept - 2.0);
  double before = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double force = proxy.cycle(hand).force.norm();
    EXPECT_LE(force - before, 0.02 + 1e-12);
    before = force;
  }
  EXPECT_NEAR(before, 2.0, accuracy);
}

TEST(HapticProxy, IsDeadUntilEngagedAndOnceReleased) {
  HapticProxy proxy(guard_of(cube()), {});
  EXPECT_EQ(proxy.cycle(above).status, CycleStatus::not_engaged);
  EXPECT_EQ(proxy.engage({test::nan, 0, 0}), CycleStatus::invalid_pose);
  EXPECT_EQ(proxy.cycle(above).status, CycleStatus::not_engaged);
  EXPECT_EQ(proxy.engage(above), CycleStatus::guarded);
  lead(proxy, above, above - Vec3(0, 0, 8.0), 100);
  EXPECT_GT(proxy.energy().largest_force, 1.0);
  proxy.release();
  EXPECT_GT(proxy.energy().largest_force, 1.0) << "to be read after the fact";
  EXPECT_EQ(proxy.cycle(above).force, Vec3::Zero());
  EXPECT_EQ(proxy.stand(CycleStatus::stale, above).status, CycleStatus::not_engaged);
  EXPECT_EQ(proxy.stand(CycleStatus::stale).status, CycleStatus::not_engaged);
  EXPECT_EQ(proxy.engage(above), CycleStatus::guarded);
  EXPECT_EQ(proxy.energy().largest_force, 0.0);
}

/// Returns the energy gain of a free mass that bounces between the top of the cube and a ceiling.
double energy_gain_of_bounces(const HapticOptions& options, EnergyReport& report) {
  HapticProxy proxy(guard_of(cube()), options);
  constexpr double mass = 2e-4;  // [N s^2 / mm]
  constexpr double speed = 50.0;
  Vec3 hand(3, 4, top + kept + 3.0), velocity(0, 0, -speed);
  proxy.engage(hand);
  for (int i = 0; i < 400; ++i) {
    const Vec3 force = proxy.cycle(hand).force;
    if (hand.z() > top + kept + 3.0 && velocity.z() > 0.0) velocity.z() *= -1.0;
    constexpr int substeps = 100;
    for (int k = 0; k < substeps; ++k) {
      velocity += force / mass * options.period / substeps;
      hand += velocity * options.period / substeps;
    }
  }
  report = proxy.energy();
  return velocity.squaredNorm() / (speed * speed);
}

TEST(HapticProxy, OfASlowLoopAndAStiffSpringThePassivityControllerTakesTheEnergy) {
  const HapticOptions slow{
      .period = 0.008, .spring = {.stiffness = 2.0, .largest_force = 100.0}, .top_speed = 1e4};
  EnergyReport active, braked;
  HapticOptions with_brake = slow;
  with_brake.largest_brake = 0.04;
  EXPECT_GT(energy_gain_of_bounces(slow, active), 3.0);
  EXPECT_GT(active.active, 0.25);
  EXPECT_LT(energy_gain_of_bounces(with_brake, braked), 1.2);
  EXPECT_GT(braked.braked, 0.0);
  expect_balance(active);
  expect_balance(braked);
}

TEST(HapticProxy, AFailedCycleWithoutTheHandLeavesNoMoreForceThanBefore) {
  const Vec3 surface(3, 4, top + kept);
  double most_braked = 0.0;
  for (int cycles = 2; cycles < 200; ++cycles) {
    HapticProxy proxy(guard_of(cube()), {.largest_brake = 0.02});
    proxy.engage(surface + Vec3(0, 0, 1));
    double before = 0.0;
    for (int i = 0; i < cycles; ++i) {
      const Vec3 hand = surface + Vec3(0, 0, 3.0 * std::cos(0.26 * i) - 1.5);
      before = proxy.cycle(hand).force.norm();
    }
    most_braked = std::max(most_braked, proxy.energy().braked);
    EXPECT_LE(proxy.stand(CycleStatus::contested).force.norm(), before) << cycles;
  }
  EXPECT_GT(most_braked, 0.0);
}

TEST(HapticProxy, WhateverOptionsAreTakenForceAndEnergyAreFiniteAndTheForceIsBounded) {
  Random random(3);
  for (int options = 0; options < 256; ++options) {
    const auto either = [options](int bit, double low, double high) {
      return (options >> bit & 1) == 0 ? low : high;
    };
    const SpringDamper spring{.stiffness = either(0, 1e-300, 1e9),
                              .damping = either(1, 0.0, 1e9),
                              .largest_force = either(2, 1e-300, 1e9),
                              .largest_rise = either(3, 1e-300, 1e300)};
    HapticProxy proxy(guard_of(cube()), {.period = either(4, 1e-6, 1.0),
                                         .spring = spring,
                                         .top_speed = either(5, 1e-6, 1e30),
                                         .farthest = either(6, 10.0, 1e30),
                                         .fade = 1.0,
                                         .largest_brake = either(7, 0.0, 1e30)});
    proxy.engage(above);
    for (int i = 0; i < test::trials(40); ++i) {
      const double far = std::pow(10.0, random.uniform(-200.0, i % 3 == 0 ? 30.0 : 1.0));
      const HapticCycle cycle = proxy.cycle(above + far * random.direction());
      ASSERT_TRUE(cycle.proxy.allFinite());
      ASSERT_TRUE(cycle.force.allFinite()) << options;
      ASSERT_LE(cycle.force.norm(), spring.largest_force * (1.0 + 1e-12)) << options;
      const EnergyReport& energy = proxy.energy();
      for (const double part : {energy.to_hand, energy.stored, energy.dissipated, energy.from_proxy,
                                energy.active, energy.braked}) {
        ASSERT_TRUE(std::isfinite(part)) << options;
      }
    }
  }
}

TEST(HapticProxy, OptionsOutOfRangeAreRefused) {
  const auto expect_refused = [](const HapticOptions& options) {
    EXPECT_THROW(HapticProxy(guard_of(cube()), options), Error);
  };
  for (const double bad : {0.0, -1.0, test::nan, test::infinity}) {
    expect_refused({.period = bad});
    expect_refused({.top_speed = bad});
    expect_refused({.farthest = bad});
    expect_refused({.fade = bad});
    expect_refused({.spring = {.stiffness = bad}});
  }
  expect_refused({.period = 1.5});
  expect_refused({.period = 1e-9});
  expect_refused({.period = std::numeric_limits<double>::denorm_min()});
  expect_refused({.largest_brake = -1.0});
  EXPECT_EQ(error_of([] { HapticProxy(guard_of(cube()), {.period = 5.0}); }),
            "haptic proxy: period, in seconds: expected a number from 1e-06 to 1, got 5");
  EXPECT_EQ(error_of([] { check(SpringDamper{.damping = -1.0}); }),
            "haptic spring: damping: expected a number from 0 to 1e9, got -1");
}

}  // namespace
}  // namespace keepout::test::haptic_proxy
