// SPDX-License-Identifier: BSD-3-Clause
// Monitors stop steps that are sabotaged, and no others.
#include <cmath>
#include <set>

#include "guards.h"
#include "keepout/activation/registry.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/monitor/inside.h"
#include "keepout/monitor/monitors.h"
#include "keepout/oracle/inside_test.h"
#include "keepout/oracle/safety_oracle.h"
#include "keepout/solvers/active_set.h"
#include "meshes.h"
#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout {
namespace {

using monitor::make_instrument_monitor;
using monitor::make_tip_monitor;
using monitor::MonitorCapacity;

std::shared_ptr<const monitor::TriangleTree> tree_of(const std::shared_ptr<const Mesh>& mesh) {
  return std::make_shared<const monitor::TriangleTree>(mesh);
}

const StepOptions tip_options{.radius = 2.0, .tool_radius = 0.3, .margin = 0.2};

/// Drives a tip around a surface, into it, and off it. Calls `seen` with each step.
template <class Seen>
void drive(MotionConstraint& guard, const Mesh& mesh, int steps, Random& random, Seen seen) {
  Vec3 tip = Vec3::Zero(), goal = Vec3::Zero();
  for (int i = 0; i < steps; ++i) {
    if (i % 200 == 0) {
      tip = surface_points(mesh, 1, random.uniform(0.1, 2.0), random).front();
      guard.forget();
    }
    if (i % 20 == 0) goal = random_points(mesh, 1, random).front();
    const double pace = std::pow(10.0, random.uniform(-3.0, 0.2));
    const Vec3 way = goal - tip + 0.3 * random.direction();
    const Vec3 desired = std::min(pace, way.norm()) * way.normalized();
    const Step step = guard.step({.tip = tip, .desired = desired});
    seen(tip, step);
    if (step.ok()) tip += step.motion;
  }
}

class TipMonitorOnEveryShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Monitor, TipMonitorOnEveryShape, testing::ValuesIn(shapes()), by_name);

TEST_P(TipMonitorOnEveryShape, ConfirmsEachStepInContactAndInRecovery) {
  const auto mesh = mesh_of(GetParam().make());
  MotionConstraint plain = make_motion_constraint(mesh, {.options = tip_options});
  MotionConstraint monitored =
      make_motion_constraint(mesh, {.options = tip_options, .monitor = true});
  Random random(1);
  std::set<Status> statuses;
  drive(monitored, *mesh, test::trials(30'000), random, [&](const Vec3&, const Step& step) {
    statuses.insert(step.status);
    ASSERT_NE(step.status, Status::unconfirmed);
  });
  EXPECT_TRUE(statuses.contains(Status::limited));
  Random one(2), other(2);
  std::vector<Vec3> motions;
  drive(plain, *mesh, 1000, one,
        [&](const Vec3&, const Step& step) { motions.push_back(step.motion); });
  std::size_t i = 0;
  drive(monitored, *mesh, 1000, other,
        [&](const Vec3&, const Step& step) { ASSERT_EQ(step.motion, motions[i++]); });
}

/// A rule that accepts every motion.
class CarelessRule final : public ActivationRule {
 public:
  Opening open(const RuleInput&, HalfSpaceBuffer&) noexcept override { return {}; }
  Judgement judge(const RuleInput&, const Vec3&, HalfSpaceBuffer&) noexcept override { return {}; }
};

/// Drives a sabotaged tip. Each motion that is made must maintain min(clearance, distance at the
/// start) from `mesh`, and the monitor must stop some.
void expect_stopped(MotionConstraint& guard, const std::shared_ptr<const Mesh>& mesh) {
  oracle::SafetyOracle oracle(mesh);
  Random random(3);
  int stopped = 0;
  drive(guard, *mesh, test::trials(10'000), random, [&](const Vec3& tip, const Step& step) {
    stopped += step.status == Status::unconfirmed ? 1 : 0;
    ASSERT_TRUE(step.ok() || step.motion.isZero(0.0));
    if (!step.ok() || step.motion.isZero(0.0)) return;
    const double required = std::min(required_clearance(tip_options), oracle.distance(tip));
    ASSERT_FALSE(oracle.check(tip, tip + step.motion, std::max(0.0, required - 1e-7)).below);
  });
  EXPECT_GT(stopped, 0);
}

MotionConstraint guard_with(const std::shared_ptr<const Mesh>& mesh,
                            std::unique_ptr<ActivationRule> rule) {
  return {mesh, std::make_shared<WideBvh>(mesh), std::move(rule), std::make_unique<ActiveSet>(),
          tip_options};
}

TEST(SabotagedTip, ARuleThatAcceptsEverythingIsStopped) {
  const auto mesh = mesh_of("cortex");
  MotionConstraint guard = guard_with(mesh, std::make_unique<CarelessRule>());
  guard.set_monitor(make_tip_monitor(tree_of(mesh)));
  expect_stopped(guard, mesh);
}

TEST(SabotagedTip, ARuleThatHasNoProofIsStopped) {
  const auto mesh = mesh_of("triangle_soup");
  MotionConstraint guard = guard_with(mesh, make_activation("paper"));
  guard.set_monitor(make_tip_monitor(tree_of(mesh)));
  expect_stopped(guard, mesh);
}

TEST(SabotagedTip, AShiftedMeshIsStopped) {
  const auto mesh = mesh_of("cortex");
  const auto shifted = mesh_of(moved(surface_of(*mesh), Vec3(0.05, -0.02, 0.04)));
  MotionConstraint guard = guard_with(shifted, make_activation("certified"));
  guard.set_monitor(make_tip_monitor(tree_of(mesh)));
  expect_stopped(guard, mesh);
}

TEST(SabotagedTip, TrianglesThatAreLeftOutAreFound) {
  const auto mesh = mesh_of("cortex");
  Surface holes = surface_of(*mesh);
  for (std::size_t t = 0; t < holes.triangles.size(); t += 2) {
    holes.triangles[t] = holes.triangles.back();
  }
  MotionConstraint guard = guard_with(mesh_of(std::move(holes)), make_activation("certified"));
  guard.set_monitor(make_tip_monitor(tree_of(mesh)));
  expect_stopped(guard, mesh);
}

TEST(SabotagedTip, AMeshThatMovedWithoutTheStepIsFound) {
  const auto mesh = mesh_of("cortex");
  const auto other = mesh_of(moved(surface_of(*mesh), Vec3(0.0, 0.0, 0.3)));
  MotionConstraint guard = guard_with(mesh, make_activation("certified"));
  auto monitor = make_tip_monitor(tree_of(mesh));
  monitor->follow(other);
  guard.set_monitor(std::move(monitor));
  expect_stopped(guard, other);
}

TEST(SabotagedTip, AMotionThatIsOneHundredthTooLongIsNotConfirmed) {
  const auto mesh = mesh_of("cortex");
  MotionConstraint guard = guard_with(mesh, make_activation("certified"));
  const auto monitor = make_tip_monitor(tree_of(mesh));
  Random random(4);
  int stopped = 0, made = 0;
  drive(guard, *mesh, test::trials(20'000), random, [&](const Vec3& tip, const Step& step) {
    if (!step.ok() || step.motion.isZero(0.0) || step.status == Status::recovering) return;
    ++made;
    ASSERT_TRUE(monitor->confirms(tip, tip + step.motion, guard.options()));
    stopped += monitor->confirms(tip, tip + 1.01 * step.motion, guard.options()) ? 0 : 1;
  });
  EXPECT_GT(stopped, made / 200);
}

/// An index that omits the triangles above a height.
class LowIndex final : public SpatialIndex {
 public:
  LowIndex(std::shared_ptr<const Mesh> mesh, double top)
      : SpatialIndex(std::move(mesh)), top_(top) {}
  void collect(const Ball&, TriangleBuffer& out) const noexcept override {
    for (TriangleId t = 0; t < mesh().triangle_count(); ++t) {
      const Triangle c = mesh().triangle(t);
      if (std::min({c[0].z(), c[1].z(), c[2].z()}) < top_) out.push(t);
    }
  }
  std::size_t memory() const noexcept override { return sizeof(*this); }

 private:
  double top_;
};

TEST(SabotagedTip, AnEscapeThroughAFaceThatTheIndexOmitsIsStopped) {
  Surface slab = surface_of(*mesh_of("cube"));
  for (Vec3& v : slab.vertices) v.z() *= 0.02;
  const auto mesh = mesh_of(std::move(slab));
  const double top = mesh->bounds().high.z();
  MotionConstraint guard = make_motion_constraint(mesh, std::make_shared<LowIndex>(mesh, 0.9 * top),
                                                  {.options = tip_options});
  for (const bool is_monitored : {false, true}) {
    if (is_monitored) guard.set_monitor(make_tip_monitor(tree_of(mesh)));
    Vec3 tip = mesh->bounds().center() + Vec3(0.13, 0.07, top + 0.6);
    int stopped = 0;
    for (int i = 0; i < 100; ++i) {
      const Step step = guard.step({.tip = tip, .desired = Vec3(0.01, 0.0, -0.05)});
      stopped += step.status == Status::unconfirmed ? 1 : 0;
      tip += step.motion;
    }
    EXPECT_EQ(tip.z() > top, is_monitored) << "the step alone believes that the tip is inside";
    EXPECT_EQ(stopped > 50, is_monitored);
  }
}

TEST(TipMonitor, ConfirmsEscapesFromTheForbiddenSideAndFromTheSurface) {
  for (const char* name : {"cube", "cortex", "gear", "far_cube"}) {
    SCOPED_TRACE(name);
    const auto mesh = mesh_of(name);
    MotionConstraint plain = make_motion_constraint(mesh, {.options = tip_options});
    MotionConstraint guard =
        make_motion_constraint(mesh, {.options = tip_options, .monitor = true});
    Random random(6);
    int escapes = 0;
    for (int i = 0; i < test::trials(3000); ++i) {
      const TriangleId t = static_cast<TriangleId>(random.below(mesh->triangle_count()));
      const Triangle c = mesh->triangle(t);
      const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      const std::array places{c[0], Vec3(0.5 * (c[0] + c[1])), Vec3((c[0] + c[1] + c[2]) / 3.0)};
      const double depth = i % 2 == 0 ? 0.0 : std::pow(10.0, random.uniform(-10.0, -0.5));
      const Vec3 tip = places[random.below(3)] - depth * normal;
      const Vec3 desired = 0.1 * random.direction();
      plain.forget();
      guard.forget();
      const Step step = guard.step({.tip = tip, .desired = desired});
      const Step expected = plain.step({.tip = tip, .desired = desired});
      ASSERT_EQ(step.status, expected.status) << tip.transpose();
      ASSERT_EQ(step.motion, expected.motion);
      escapes += step.status == Status::recovering && !step.motion.isZero(0.0) ? 1 : 0;
    }
    EXPECT_GT(escapes, test::trials(300));
  }
}

TEST(SideTest, AgreesWithTheOracle) {
  for (const char* name : {"cube", "cortex", "gear", "needles", "far_cube"}) {
    SCOPED_TRACE(name);
    const auto mesh = mesh_of(name);
    const auto tree = tree_of(mesh);
    const oracle::InsideTest oracle(tree);
    monitor::SideTest side(tree, 16'384);
    Random random(7);
    int undecided = 0;
    for (const Vec3& point : random_points(*mesh, test::trials(4000), random)) {
      const std::optional<bool> found = side.is_forbidden(point, 65'536);
      undecided += found ? 0 : 1;
      if (!found) continue;
      ASSERT_TRUE(oracle.closed());
      ASSERT_EQ(*found, *oracle.inside(point)) << point.transpose();
    }
    EXPECT_LE(undecided, oracle.closed() ? test::trials(40) : test::trials(4000));
    EXPECT_FALSE(side.is_forbidden(mesh->bounds().center(), 3));
  }
}

TEST(TipMonitor, HasTheSameAnswersAndWorkInAnyUnit) {
  const auto mesh = mesh_of("cortex");
  std::vector<Status> expected;
  for (const double unit : {1.0, 0x1p-10, 0x1p10}) {
    SCOPED_TRACE(unit);
    Surface surface = surface_of(*mesh);
    for (Vec3& v : surface.vertices) v *= unit;
    const auto scaled = mesh_of(std::move(surface));
    StepOptions options = tip_options;
    for (double* length : {&options.radius, &options.tool_radius, &options.margin,
                           &options.recovery, &options.deepest}) {
      *length *= unit;
    }
    MotionConstraint guard = make_motion_constraint(scaled, {.options = options});
    guard.set_monitor(make_tip_monitor(tree_of(scaled), {.work = 400}));
    Random random(8);
    std::vector<Status> statuses;
    Vec3 tip = Vec3::Zero();
    for (int i = 0; i < 2000; ++i) {
      if (i % 100 == 0) tip = surface_points(*mesh, 1, 1.0, random).front();
      const Vec3 desired = 0.3 * random.direction();
      const Step step = guard.step({.tip = unit * tip, .desired = unit * desired});
      statuses.push_back(step.status);
      tip += step.motion / unit;
    }
    if (expected.empty()) expected = statuses;
    EXPECT_EQ(statuses, expected);
  }
  EXPECT_TRUE(std::ranges::count(expected, Status::unconfirmed) > 0) << "the work is never scarce";
}

TEST(TipMonitor, FollowsTheMeshOfTheConstraint) {
  const auto mesh = mesh_of("cortex");
  const auto other = mesh_of(moved(surface_of(*mesh), Vec3(0.0, 0.0, 50.0)));
  MotionConstraint guard = make_motion_constraint(mesh, {.options = tip_options, .monitor = true});
  guard.follow(other, std::make_shared<WideBvh>(other));
  Random random(5);
  drive(guard, *other, test::trials(10'000), random,
        [&](const Vec3&, const Step& step) { ASSERT_NE(step.status, Status::unconfirmed); });
}

TEST(TipMonitor, ConfirmsNothingWithoutWorkOrWithNumbersThatAreNotFinite) {
  const auto mesh = mesh_of("cube");
  const Vec3 far = mesh->bounds().high + Vec3(5.0, 5.0, 5.0);
  const auto confirms = [&](const MonitorCapacity& capacity, const Vec3& to, double margin) {
    StepOptions options = tip_options;
    options.margin = margin;
    return make_tip_monitor(tree_of(mesh), capacity)->confirms(far, to, options);
  };
  const double nan = std::nan("");
  EXPECT_TRUE(confirms({}, far + Vec3::UnitX(), 0.2));
  EXPECT_FALSE(confirms({}, Vec3(nan, 0.0, 0.0), 0.2));
  EXPECT_FALSE(confirms({}, Vec3(test::infinity, 0.0, 0.0), 0.2));
  EXPECT_FALSE(confirms({}, far + Vec3::UnitX(), nan));
  EXPECT_FALSE(confirms({.work = 10}, far + Vec3::UnitX(), 0.2));
  EXPECT_FALSE(confirms({.triangles = 1}, far + Vec3::UnitX(), 30.0));
  EXPECT_THROW(make_tip_monitor(nullptr), Error);
}

TEST(TipMonitor, AStepThatIsNotConfirmedHasNoMotionAndAReason) {
  const auto mesh = mesh_of("cube");
  MotionConstraint guard = guard_with(mesh, make_activation("certified"));
  guard.set_monitor(make_tip_monitor(tree_of(mesh), {.work = 0}));
  const Vec3 far = mesh->bounds().high + Vec3(5.0, 5.0, 5.0);
  const Step step = guard.step({.tip = far, .desired = Vec3::UnitX()});
  EXPECT_EQ(step.status, Status::unconfirmed);
  EXPECT_FALSE(step.ok());
  EXPECT_TRUE(step.motion.isZero(0.0));
  EXPECT_TRUE(step.increment.empty());
  EXPECT_EQ(name(step.status), "unconfirmed");
  EXPECT_NE(step.reason().find("monitor"), std::string_view::npos);
  guard.set_monitor(nullptr);
  EXPECT_TRUE(guard.step({.tip = far, .desired = Vec3::UnitX()}).ok());
}

// An instrument over a gear.

const InstrumentOptions instrument_options{.margin = 0.2, .band = 0.002, .period = 0.5};
const Pose port{Vec3(0.3, 0.2, 120.0), Mat3::Identity()};

/// Pushes the instrument onto the mesh and around on it. Calls `seen` with each step.
template <class Seen>
void push(InstrumentConstraint& guard, int cycles, double pace, Random& random, Seen seen) {
  std::vector<double> q;
  Vec3 way = Vec3::Zero();
  for (int i = 0; i < cycles; ++i) {
    if (i % 400 == 0)
      q = {0.3 * random.uniform(-1.0, 1.0), 0.3 * random.uniform(-1.0, 1.0), 30.0, 0.0, 0.0, 0.0};
    if (i % 400 == 0) guard.forget();
    if (i % 40 == 0) way = random.direction() - 0.7 * Vec3::UnitZ();
    const InstrumentStep step = guard.step(q, {.linear = pace * (way + 0.3 * random.direction()),
                                               .angular = 0.05 * pace * random.direction()});
    seen(q, step);
    for (std::size_t k = 0; step.ok() && k < q.size(); ++k) q[k] += step.increment[k];
  }
}

TEST(InstrumentMonitor, ConfirmsEachCycleInContactAndInRecovery) {
  const auto mesh = mesh_of("gear");
  InstrumentConstraint guard =
      make_instrument_constraint(mesh, psm(port), {.monitor = true, .options = instrument_options});
  Random random(6);
  std::set<Status> statuses;
  int cycles = 0;
  push(guard, test::trials(40'000), 1.0, random, [&](std::span<const double>, const auto& step) {
    statuses.insert(step.status);
    ASSERT_NE(step.status, Status::unconfirmed);
    if (++cycles % 100 != 0) return;
    InstrumentOptions options = instrument_options;
    if (cycles % 200 == 0) options.margin += 0.5;
    guard.set_options(options);
  });
  EXPECT_TRUE(statuses.contains(Status::limited));
  EXPECT_TRUE(statuses.contains(Status::recovering));
}

TEST(InstrumentMonitor, ConfirmsEachCycleBesideMeshesThatMove) {
  const auto mesh = mesh_of("gear");
  const auto cube = mesh_of(make_cube(20.0));
  InstrumentConstraint guard =
      make_instrument_constraint(mesh, psm(port), {.monitor = true, .options = instrument_options});
  guard.add_mesh(cube, std::make_shared<WideBvh>(cube), 0.5);
  Random random(7);
  std::set<Status> statuses;
  int cycles = 0;
  push(guard, test::trials(20'000), 0.3, random, [&](std::span<const double>, const auto& step) {
    statuses.insert(step.status);
    ASSERT_NE(step.status, Status::unconfirmed) << cycles;
    const double time = 0.1 * ++cycles;
    guard.place(
        0, {Vec3(0.0, 0.0, 3.0 * std::sin(time)), Mat3::Identity()},
        {.linear = Vec3(0.0, 0.0, 0.6 * std::cos(time)), .angular = 0.02 * random.direction()});
    guard.place(1, {Vec3(80.0, 0.0, 0.0), Mat3::Identity()}, {.linear = random.direction()});
  });
  EXPECT_TRUE(statuses.contains(Status::limited));
}

int stopped_in(InstrumentConstraint& guard, double pace = 1.0) {
  Random random(8);
  int stopped = 0;
  push(guard, test::trials(10'000), pace, random, [&](std::span<const double>, const auto& step) {
    stopped += step.status == Status::unconfirmed ? 1 : 0;
    ASSERT_TRUE(step.ok() || step.increment.empty());
  });
  return stopped;
}

TEST(SabotagedInstrument, IsStopped) {
  const auto mesh = mesh_of("gear");
  const auto with = [&](const std::shared_ptr<const Mesh>& other, const Instrument& instrument,
                        InstrumentOptions options = instrument_options) {
    InstrumentConstraint guard(other, std::make_shared<WideBvh>(other), instrument,
                               std::make_unique<ActiveSet>(), options);
    guard.set_monitor(make_instrument_monitor(psm(port), {tree_of(mesh)}));
    return guard;
  };
  InstrumentConstraint sound = with(mesh, psm(port));
  EXPECT_EQ(stopped_in(sound), 0);
  InstrumentConstraint shifted =
      with(mesh_of(moved(surface_of(*mesh), Vec3(0.02, 0.0, -0.05))), psm(port));
  EXPECT_GT(stopped_in(shifted), 0);
  Pose elsewhere = port;
  elsewhere.position.z() += 0.05;
  InstrumentConstraint misplaced = with(mesh, psm(elsewhere));
  EXPECT_GT(stopped_in(misplaced), 0);
  const Instrument whole = psm(port);
  std::vector<Body> thin(whole.bodies().begin(), whole.bodies().end());
  for (Body& body : thin) body.radius *= 0.95;
  InstrumentConstraint slender = with(mesh, Instrument(whole.chain(), thin));
  EXPECT_GT(stopped_in(slender), 0);
  InstrumentOptions straight = instrument_options;
  straight.certified = CertifiedMotion::linearized;
  straight.period = 10.0;
  InstrumentConstraint linearized = with(mesh, psm(port), straight);
  EXPECT_GT(stopped_in(linearized, 8.0), 0);
  InstrumentConstraint forgetful(psm(port), std::make_unique<ActiveSet>(), instrument_options);
  forgetful.set_monitor(make_instrument_monitor(psm(port), {tree_of(mesh)}));
  EXPECT_GT(stopped_in(forgetful), test::trials(9'000)) << "it has no mesh";
}

TEST(InstrumentMonitor, ConfirmsNothingThatDoesNotFit) {
  const auto mesh = mesh_of("gear");
  const auto monitor = make_instrument_monitor(psm(port), {tree_of(mesh)});
  const std::vector<double> q{0.0, 0.0, 30.0, 0.0, 0.0, 0.0};
  std::vector<double> next = q;
  next[2] += 1.0;
  const std::array<MonitoredMotion::OfMesh, 1> still{};
  std::array<MonitoredMotion::OfPair, 3> pairs;
  pairs.fill({0.198, 0.198, 0.002});
  const auto confirms = [&](std::span<const double> to) {
    return monitor->confirms({q, to, still, pairs, 1e-9});
  };
  EXPECT_TRUE(confirms(next));
  EXPECT_FALSE(confirms({}));
  next[0] = std::nan("");
  EXPECT_FALSE(confirms(next));
  next[0] = 0.0;
  pairs[1].certified = 0.1;  // less than its distance demands
  EXPECT_FALSE(confirms(next));
  pairs[1].certified = -test::infinity;  // nothing, although no mesh moves
  EXPECT_FALSE(confirms(next));
  EXPECT_THROW(monitor->follow(nullptr, 0), Error);
  EXPECT_THROW(monitor->follow(mesh, 5), Error);
}

TEST(Monitor, AllocatesNothingAfterConstruction) {
  const auto mesh = mesh_of("cortex");
  MotionConstraint tip = make_motion_constraint(mesh, {.options = tip_options, .monitor = true});
  const auto gear = mesh_of("gear");
  InstrumentConstraint instrument =
      make_instrument_constraint(gear, psm(port), {.monitor = true, .options = instrument_options});
  Random random(9);
  std::size_t counted = 0;
  std::size_t before = allocations();
  drive(tip, *mesh, 150, random, [&](const Vec3&, const Step&) {});  // one start
  before = allocations();
  std::vector<Vec3> tips = surface_points(*mesh, 50, 0.6, random);
  const std::vector<Vec3> inside = surface_points(*mesh, 50, -0.3, random);
  tips.insert(tips.end(), inside.begin(), inside.end());
  tips.insert(tips.end(), mesh->vertices().begin(), mesh->vertices().begin() + 50);
  int escapes = 0;
  std::vector<double> q{0.0, 0.0, 30.0, 0.0, 0.0, 0.0};
  before = allocations();
  for (const Vec3& place : tips) {
    tip.forget();
    const Step step =
        tip.step({.tip = place, .desired = random.uniform(0.0, 1.9) * random.direction()});
    escapes += step.status == Status::recovering ? 1 : 0;
  }
  for (int i = 0; i < 200; ++i) {
    const InstrumentStep step = instrument.step(q, {.linear = random.direction() - Vec3::UnitZ()});
    for (std::size_t k = 0; step.ok() && k < q.size(); ++k) q[k] += step.increment[k];
  }
  counted = allocations() - before;
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(escapes, 50);
}

}  // namespace
}  // namespace keepout
