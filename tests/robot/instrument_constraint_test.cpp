// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument_constraint.h"

#include "brute_force.h"
#include "guards.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/robot/motion_bounds.h"
#include "keepout/solvers/registry.h"
#include "messages.h"
#include "stub_solver.h"

namespace keepout {
namespace {

std::vector<double> straight_down(double insertion) { return {0, 0, insertion, 0, 0, 0}; }

/// Returns a psm that hangs down from its port, 120 above the origin. At insertion d its tip is at
/// height 120 - d - 9.1 - 10.2 + 15.6.
Instrument psm_above() { return psm(port_over(Vec3::Zero(), 120.0)); }

/// Returns a ball of radius 1 that one prismatic joint carries along z.
Instrument ball_on_a_slide(const Pose& base = {}) {
  return {Chain({{.kind = JointKind::prismatic}}, base),
          {{.points = {{1, Vec3::Zero()}}, .radius = 1.0}}};
}

/// Returns the least clearance that a constraint certifies, to within its rounding.
double certified_by(const InstrumentConstraint& guard) {
  return guard.options().margin - guard.options().band - 3.0 * guard.tolerance();
}

/// Returns the insertion with this distance from a cube whose top is at 50.
double insertion_above_cube(const Instrument& instrument, const Mesh& mesh, double distance) {
  double low = 10.0;
  double high = 200.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (clearance_of(instrument, mesh, straight_down(middle)) > distance ? low : high) = middle;
  }
  return low;
}

TEST(InstrumentConstraint, StopsAtASurfaceAtTheMarginAndSlidesAlongIt) {
  const auto mesh = mesh_of(make_cube(20.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.05});
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 3.0));
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 30; ++i) {
    const InstrumentStep step = guard.step(q, {.linear = Vec3(0.1, 0.0, -0.5)});
    ASSERT_TRUE(step.ok()) << step.reason();
    const ChainState chain = test::state_of(instrument.chain(), q);
    before = chain.flange().position;
    q = moved(q, step);
  }
  const ChainState chain = test::state_of(instrument.chain(), q);
  EXPECT_NEAR(chain.flange().position.x() - before.x(), 0.1, 0.02) << "it slides";
  EXPECT_NEAR(clearance_of(instrument, *mesh, q), guard.options().margin, 2e-3);
  EXPECT_GE(clearance_of(instrument, *mesh, q), certified_by(guard));
}

// A body within its band returns to the margin, even if the command is shorter than the band. So
// the step may miss the command by more than zero motion does, but by at most two bands.
TEST(InstrumentConstraint, MissesAShortCommandByAtMostTwoBandsMoreThanZeroMotion) {
  const auto mesh = mesh_of(make_cube(20.0));
  auto guard = guard_of(mesh, free_ball(1.0));
  const double band = guard.options().band;
  Random random(41);
  int farther = 0;
  for (int i = 0; i < test::trials(2000); ++i) {
    guard.forget();
    const double clearance = guard.options().margin - random.uniform(0.0, 0.99) * band;
    const std::vector<double> q{random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0),
                                51.0 + clearance};
    const Vec3 desired = random.uniform(0.1, 2.0) * band * random.direction();
    const InstrumentStep step = guard.step(q, {.linear = desired});
    ASSERT_TRUE(step.ok()) << step.reason();
    const Vec3 made(step.increment[0], step.increment[1], step.increment[2]);
    const double missed = (made - desired).norm();
    EXPECT_LE(missed, desired.norm() + 2.0 * band);
    EXPECT_GE(clearance + made.z(), guard.options().margin - band - 3.0 * guard.tolerance());
    farther += missed > 1.05 * desired.norm() ? 1 : 0;
  }
  EXPECT_GT(farther, test::trials(200));
}

TEST(InstrumentConstraint, WithoutAMeshGoesWhereItIsAskedToUntilOneIsAdded) {
  const auto mesh = mesh_of(make_cube(20.0));
  const Instrument instrument = psm_above();
  InstrumentConstraint guard(instrument, std::make_unique<ActiveSet>(), {.period = 0.05});
  EXPECT_EQ(guard.mesh_count(), 0u);
  EXPECT_GT(guard.tolerance(), 0.0);
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 0.3));
  const Twist down{.linear = Vec3(0.0, 0.0, -0.5)};
  const InstrumentStep free = guard.step(q, down);
  ASSERT_TRUE(free.ok()) << free.reason();
  EXPECT_EQ(free.status, Status::free);
  EXPECT_LT(clearance_of(instrument, *mesh, moved(q, free)), -0.1) << "into the cube";
  EXPECT_EQ(guard.add_mesh(mesh, make_index("wide_bvh", mesh)), 0u);
  const InstrumentStep limited = guard.step(q, down);
  EXPECT_EQ(limited.status, Status::limited);
  EXPECT_GE(clearance_of(instrument, *mesh, moved(q, limited)), certified_by(guard));
  // The step keeps a prismatic joint at its limit, with and without a mesh.
  InstrumentConstraint at_its_limit(instrument, std::make_unique<ActiveSet>(), {.period = 0.05});
  q[2] = instrument.chain().joint(3).limits.upper;
  EXPECT_LE(moved(q, at_its_limit.step(q, down))[2], q[2] + 1e-12);
}

// On generated shapes, with each index and each solver: no step ends below the certified clearance,
// or passes below it on the way. All indices give bitwise identical results.
TEST(InstrumentConstraint, KeepsEveryBodyClearOnEveryIndexAndEverySolver) {
  struct Part {
    std::string_view index, solver;
  };
  std::vector<Part> parts;
  for (const IndexBackend& index : index_backends()) parts.push_back({index.name, "active_set"});
  for (const SolverBackend& solver : solver_backends()) parts.push_back({"wide_bvh", solver.name});
  for (const std::string_view shape : {"cube", "pyramid"}) {
    const auto mesh = mesh_of(shape);
    std::vector<double> first_way;
    for (const Part& part : parts) {
      SCOPED_TRACE(testing::Message() << shape << " " << part.index << " " << part.solver);
      const Instrument instrument = psm_above();
      InstrumentConstraint guard(mesh, make_index(part.index, mesh), instrument,
                                 make_solver(part.solver), {.period = 0.05});
      std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 5.0));
      Random random(3);
      std::vector<double> way;
      int held = 0;
      const int cycles = test::trials(part.solver == "active_set" ? 60 : 20);  // others are slow
      for (int i = 0; i < cycles; ++i) {
        const Twist desired{.linear = Vec3(0, 0, -1.0) + random.direction(),
                            .angular = 0.05 * random.direction()};
        const InstrumentStep step = guard.step(q, desired);
        if (!step.ok()) continue;  // a solver may fail
        held += step.status == Status::limited ? 1 : 0;
        for (const double share : {0.37, 1.0}) {
          ASSERT_GE(clearance_of(instrument, *mesh, moved(q, step, share)), certified_by(guard));
        }
        q = moved(q, step);
        way.insert(way.end(), q.begin(), q.end());
      }
      EXPECT_GT(held, cycles / 10);
      if (part.solver != "active_set") continue;
      if (first_way.empty()) first_way = way;
      EXPECT_EQ(way, first_way);
    }
  }
}

TEST(InstrumentConstraint, KeepsEveryBodyClearWhateverASolverAnswers) {
  Random lies(1);
  std::vector<double> u(6);
  const auto answer = [&](const StepProblem&, Solution& solution) {
    for (double& x : u) x = lies.uniform(-0.02, 0.02);
    u[2] = lies.uniform(-0.5, 3.0);  // the insertion, down into the cube
    solution.u = u;
    return SolveStatus::optimal;
  };
  const auto mesh = mesh_of(make_cube(20.0));
  const Instrument instrument = psm_above();
  InstrumentConstraint guard(mesh, std::make_shared<WideBvh>(mesh), instrument, solver_that(answer),
                             {.period = 0.05});
  const double kept = certified_by(guard);
  const std::vector<double> start = straight_down(insertion_above_cube(instrument, *mesh, 1.0));
  std::vector<double> q = start;
  int moves = 0;
  for (int i = 0; i < test::trials(500); ++i) {
    if (i % 20 == 0) {
      q = start;
      guard.forget();
    }
    const InstrumentStep step = guard.step(q, {.linear = Vec3(0, 0, -0.5)});
    ASSERT_TRUE(step.ok() || step.increment.empty());
    for (const double share : {0.5, 1.0}) {
      ASSERT_GE(clearance_of(instrument, *mesh, moved(q, step, share)), kept) << name(step.status);
    }
    moves += step.ok() && moved(q, step) != q ? 1 : 0;
    q = moved(q, step);
  }
  EXPECT_GT(moves, test::trials(25));
}

// Samples random motions, some of them large. Each part that is proved must be clear, and nearly
// all clear motions must be proved.
TEST(InstrumentConstraint, ProvesWhatIsFreeAndNothingElse) {
  const auto mesh = mesh_of(make_sphere(12.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.05});
  const double kept = guard.options().margin - guard.options().band;
  Random random(5);
  int free = 0;
  int proven = 0;
  int partly = 0;
  for (int i = 0; i < test::trials(1200); ++i) {
    std::vector<double> q = straight_down(random.uniform(40.0, 80.0));
    for (const std::size_t k : {0u, 1u}) q[k] = random.uniform(-0.3, 0.3);
    for (const std::size_t k : {3u, 4u, 5u}) q[k] = random.uniform(-0.8, 0.8);
    if (clearance_of(instrument, *mesh, q) < kept) continue;
    std::vector<double> dq(6);
    for (double& number : dq) number = random.uniform(-0.4, 0.4);
    dq[2] *= 25.0;
    const MotionProof proof = guard.prove(q, dq);
    ASSERT_TRUE(is_ok(proof.status)) << proof.reason();
    double least = test::infinity;
    for (int s = 0; s <= 20; ++s) {
      std::vector<double> there = q;
      for (std::size_t k = 0; k < 6; ++k) there[k] += s / 20.0 * dq[k];
      const double clear = clearance_of(instrument, *mesh, there);
      least = std::min(least, clear);
      if (s <= 20.0 * proof.fraction) {
        ASSERT_GE(clear, kept - 3.0 * guard.tolerance());
      }
    }
    free += least > kept + 0.01 ? 1 : 0;
    proven += least > kept + 0.01 && proof.fraction == 1.0 ? 1 : 0;
    partly += proof.fraction > 0.0 && proof.fraction < 1.0 ? 1 : 0;
  }
  EXPECT_GT(free, test::trials(50));
  EXPECT_GT(partly, test::trials(20));
  EXPECT_GE(proven, free * 98 / 100);
}

TEST(InstrumentConstraint, ProvesLongMotionsInPartsWhereThereIsNoRoomForThemAtOnce) {
  const auto mesh = mesh_of(make_cube(2.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {}, {.triangles = 1000});
  const std::vector<double> q = straight_down(20.0);
  const double free = insertion_above_cube(instrument, *mesh, 0.2) - 20.0;
  const MotionProof clear = guard.prove(q, std::vector<double>{0, 0, free - 0.01, 0, 0, 0});
  EXPECT_EQ(clear.status, Status::free) << clear.reason();
  EXPECT_TRUE(clear.is_clear());
  const MotionProof through = guard.prove(q, std::vector<double>{0, 0, 100.0, 0, 0, 0});
  EXPECT_EQ(through.status, Status::limited);
  EXPECT_NEAR(100.0 * through.fraction, free, 100.0 / 64.0 + 0.01);
  EXPECT_LE(100.0 * through.fraction, free + 0.002);
}

TEST(InstrumentConstraint, ProvesLongMotionsInPartsWhereThereIsNoWorkForThemAtOnce) {
  const auto mesh = mesh_of("gear");
  const Instrument instrument = psm_above();
  std::vector<double> all(6, 0.0);
  all[0] = -0.3;
  const auto prove = [&](std::size_t work_units) {
    auto guard = guard_of(mesh, instrument, {}, {.work_units = work_units});
    std::vector<double> q = straight_down(20.0);
    q[0] = 0.1;
    const MotionProof proof = guard.prove(q, all);
    return std::pair(proof, guard.work_units());
  };
  const auto [whole, work_units] = prove(0);
  ASSERT_GT(whole.fraction, 0.2) << whole.reason();
  ASSERT_GT(work_units, 50);
  const auto [parts, spent] = prove(work_units - 1);
  EXPECT_EQ(parts.status, whole.status) << parts.reason();
  EXPECT_NEAR(parts.fraction, whole.fraction, 1.0 / 64.0);
  EXPECT_EQ(prove(3).first.status, Status::out_of_budget);
}

TEST(InstrumentConstraint, ChecksTheSideOnceItIsToldTo) {
  const auto mesh = mesh_of(make_cube(10.0));
  auto guard = guard_of(mesh, ball_on_a_slide(), {.check_sides = false});
  const std::vector<double> q{0.0};
  EXPECT_EQ(guard.step(q, Twist{}).status, Status::free);
  InstrumentOptions options = guard.options();
  options.check_sides = true;
  guard.set_options(options);
  EXPECT_EQ(guard.step(q, Twist{}).status, Status::inside);
}

TEST(InstrumentConstraint, KeepsWhatWasGainedWhateverIsProvenInBetween) {
  const auto mesh = mesh_of(make_cube(10.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.05});
  InstrumentOptions options = guard.options();
  options.margin = 1.0;
  options.band = 0.1;
  options.recovery = 0.01;
  guard.set_options(options);
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 0.5));
  q = moved(q, guard.step(q, Twist{}));
  const double floor = clearance_of(instrument, *mesh, q) - options.band;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(guard.prove(q, std::vector<double>(6, 0.0)).status, Status::recovering);
    const InstrumentStep step = guard.step(q, {.linear = Vec3(0, 0, -0.05)});
    ASSERT_TRUE(step.ok()) << step.reason();
    q = moved(q, step);
    ASSERT_GE(clearance_of(instrument, *mesh, q), floor - 3.0 * guard.tolerance());
  }
}

TEST(InstrumentConstraint, RefusesPositionsThatLoseTheDigitsOfAWay) {
  const auto mesh = mesh_of("cube");
  auto guard = guard_of(mesh, psm_above(), {.period = 0.05});
  std::vector<double> q = straight_down(20.0);
  EXPECT_TRUE(guard.step(q, Twist{}).ok());
  q[3] = 101.0;  // beyond 100 rad
  EXPECT_EQ(guard.step(q, Twist{}).status, Status::invalid_input);
  EXPECT_EQ(guard.prove(q, std::vector<double>(6, 0.0)).status, Status::invalid_input);
  const std::vector<double> far{0, 0, 1e8, 0, 0, 0};
  EXPECT_EQ(guard.prove(straight_down(20.0), far).status, Status::invalid_input);
  // A joint without limits is not moved beyond the positions that the next cycle accepts.
  auto free = guard_of(mesh, ball_on_a_slide({Vec3(0, 0, 500)}), {.period = 0.05});
  std::vector<double> at{0.0};
  for (int i = 0; i < 3; ++i) {
    const InstrumentStep step = free.step(at, std::vector<double>{1e9});
    ASSERT_TRUE(step.ok()) << step.reason();
    at = moved(at, step);
  }
  EXPECT_GT(at[0], 1e4);
}

// A beating surface, refit ten times per beat. Each step preserves the margin, or the clearance at
// its start if that is smaller, less the band.
TEST(InstrumentConstraint, FollowsAnatomyThatDeforms) {
  const Surface still = make_shape("sphere");
  const auto at = [&](double beats) { return mesh_of(beating(still, beats)); };
  auto mesh = at(0.0);
  const auto tree = std::make_shared<WideBvh>(mesh);
  const Instrument instrument = psm_above();
  const InstrumentOptions options{.margin = 0.5, .period = 0.05};
  InstrumentConstraint guard(mesh, tree, instrument, make_solver("active_set"), options);
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 0.6));
  int recovering = 0;
  int held = 0;
  Random random(13);
  for (int refit = 1; refit <= test::trials(60); ++refit) {
    mesh = at(0.1 * refit);
    tree->refit(mesh);
    EXPECT_EQ(guard.step(q, Twist{}).status, Status::mesh_changed);
    EXPECT_EQ(guard.prove(q, std::vector<double>(6, 0.0)).status, Status::mesh_changed);
    guard.follow(mesh, tree);
    EXPECT_EQ(&guard.mesh(), mesh.get());
    double before = clearance_of(instrument, *mesh, q);
    ASSERT_GT(before, 0.0);
    for (int cycle = 0; cycle < 10; ++cycle) {
      const InstrumentStep step =
          guard.step(q, {.linear = Vec3(0, 0, -0.3) + 0.2 * random.direction()});
      ASSERT_TRUE(step.ok()) << step.reason();
      recovering += step.status == Status::recovering ? 1 : 0;
      held += step.status == Status::limited ? 1 : 0;
      q = moved(q, step);
      const double now = clearance_of(instrument, *mesh, q);
      ASSERT_GE(now, std::min(options.margin, before) - options.band - 3.0 * guard.tolerance());
      before = now;
    }
  }
  EXPECT_GT(recovering, test::trials(20));
  EXPECT_GT(held, test::trials(50));
  EXPECT_THROW(guard.follow(mesh_of("cube"), tree), Error) << "an index of another mesh";
  EXPECT_TRUE(guard.step(q, Twist{}).ok()) << "and it stays as it was";
}

TEST(InstrumentConstraint, NeverLeavesTheLimitsOfItsJoints) {
  const auto mesh = mesh_of("cube");
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.02});
  std::vector<double> q = straight_down(20.0);
  int at_limit = 0;
  for (int i = 0; i < test::trials(4000); ++i) {
    std::vector<double> desired(6);
    for (std::size_t k = 0; k < 6; ++k)
      desired[k] = (k == 2 ? 5.0 : 0.2) * (i / 200 % 2 == 0 ? 1 : -1);
    const InstrumentStep step = guard.step(q, desired);
    if (!step.ok()) continue;
    const std::vector<double> next = moved(q, step);
    for (int k = 1; k <= 6; ++k) {
      const auto j = static_cast<std::size_t>(k - 1);
      const JointLimits& limits = instrument.chain().joint(k).limits;
      ASSERT_LE(next[j], limits.upper);
      ASSERT_GE(next[j], limits.lower);
      ASSERT_LE(std::abs(step.increment[j]), limits.velocity * 0.02 * (1.0 + 1e-12));
      at_limit += next[j] == limits.upper || next[j] == limits.lower ? 1 : 0;
    }
    q = next;
  }
  EXPECT_GT(at_limit, test::trials(100));
}

// The limits hold exactly for q + dq as the caller computes it.
TEST(InstrumentConstraint, EndsWithinLimitsWhateverTheRounding) {
  const auto mesh = mesh_of(make_cube(50.0));
  Random random(12);
  int at_limit = 0;
  for (int i = 0; i < test::trials(2000); ++i) {
    const double lower = random.uniform(-1.0, 0.0) * std::pow(10.0, random.uniform(-3.0, 1.0));
    const double upper = random.uniform(0.0, 1.0) * std::pow(10.0, random.uniform(-3.0, 1.0));
    const Chain chain({{.limits = {.lower = lower, .upper = upper}}}, {Vec3(200, 0, 0)});
    auto guard =
        guard_of(mesh, Instrument(chain, {{.points = {{1, Vec3(1, 0, 0)}}, .radius = 1.0}}),
                 {.period = 0.05});
    std::vector<double> q{random.uniform(lower, upper)};
    for (const double way : {100.0, -100.0, random.uniform(-2.0, 2.0), 100.0}) {
      const InstrumentStep step = guard.step(q, std::vector<double>{way});
      ASSERT_TRUE(step.ok()) << step.reason();
      q = moved(q, step);
      ASSERT_GE(q[0], lower);
      ASSERT_LE(q[0], upper);
      at_limit += q[0] > upper - 1e-12 || q[0] < lower + 1e-12 ? 1 : 0;
    }
  }
  EXPECT_GT(at_limit, test::trials(5000));
}

TEST(InstrumentConstraint, ComesBackToARaisedMarginWithoutEverComingCloser) {
  const auto mesh = mesh_of(make_cube(10.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.05});
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, 0.3));
  for (int i = 0; i < 5; ++i) q = moved(q, guard.step(q, {.linear = Vec3(0, 0, -0.5)}));
  InstrumentOptions options = guard.options();
  options.margin = 0.7;
  guard.set_options(options);
  double last = clearance_of(instrument, *mesh, q);
  int cycles = 0;
  for (; last < options.margin - options.band && cycles < 100; ++cycles) {
    const InstrumentStep step = guard.step(q, {.linear = Vec3(0, 0, -0.5)});
    ASSERT_EQ(step.status, Status::recovering) << step.reason();
    q = moved(q, step);
    const double now = clearance_of(instrument, *mesh, q);
    ASSERT_GE(now, last - options.band - 3.0 * guard.tolerance());
    last = now;
  }
  EXPECT_LT(cycles, 30);
}

TEST(InstrumentConstraint, LeadsOutABodyThatReachesThroughTheSurface) {
  const auto mesh = mesh_of(make_cube(10.0));
  const Instrument instrument = psm_above();
  auto guard = guard_of(mesh, instrument, {.period = 0.05});
  std::vector<double> q = straight_down(insertion_above_cube(instrument, *mesh, -0.5));
  ASSERT_NEAR(clearance_of(instrument, *mesh, q), -0.5, 1e-6) << "the cutter's round end is in";
  InstrumentStep step = guard.step(q, Twist{});
  EXPECT_EQ(step.status, Status::recovering);
  ASSERT_TRUE(step.distance.has_value());
  EXPECT_NEAR(*step.distance, -0.5, 1e-6);
  EXPECT_EQ(step.nearest, 2);
  for (int i = 0; i < 40 && step.status == Status::recovering; ++i) {
    q = moved(q, step);
    step = guard.step(q, Twist{});
  }
  EXPECT_TRUE(step.status == Status::free || step.status == Status::limited) << step.reason();
  EXPECT_GE(clearance_of(instrument, *mesh, q), 0.198 - 3.0 * guard.tolerance());
}

TEST(InstrumentConstraint, MovesNothingThatIsThroughTheSurfaceOrBehindIt) {
  const auto mesh = mesh_of(make_cube(10.0));
  auto guard = guard_of(mesh, psm_above(), {.period = 0.05});
  const std::vector<double> through =
      straight_down(insertion_above_cube(psm_above(), *mesh, 0.0) + 5.0);
  EXPECT_EQ(guard.step(through, Twist{.linear = Vec3(0, 0, 1)}).status, Status::touching);
  EXPECT_TRUE(guard.step(through, Twist{}).increment.empty());
  // A ball that is entirely inside.
  auto inside = guard_of(mesh, ball_on_a_slide(), {.period = 0.05});
  const std::vector<double> q{0.0};
  EXPECT_EQ(inside.step(q, Twist{}).status, Status::inside);
  EXPECT_TRUE(inside.step(q, Twist{}).increment.empty());
  EXPECT_EQ(inside.prove(q, q).status, Status::inside);
  inside.set_guides({Guide::point("down", {1, Vec3::Zero()}, Region::ball(Vec3(0, 0, -90), 1.0))});
  EXPECT_EQ(inside.step(q, Twist{}).status, Status::inside);
  auto unchecked = guard_of(mesh, ball_on_a_slide(), {.check_sides = false});
  EXPECT_EQ(unchecked.step(q, Twist{}).status, Status::free) << "of any surface, the side it is on";
}

TEST(InstrumentConstraint, ABladeThatTurnsIsKeptOffByItsEdges) {
  const auto mesh = mesh_of(make_cube(10.0));
  const Pose above{Vec3(0, 0, 53), Mat3::Identity()};
  // The blade is 4 wide and turns about y. It is 3 above the cube if it is flat, and 1 above if it
  // is upright.
  const Chain chain({{.axis = Vec3::UnitY()}}, above);
  const std::vector<LinkPoint> corners{{1, Vec3(-2, -1, 0)}, {1, Vec3(2, -1, 0)},
                                       {1, Vec3(-2, 1, 0)},  {1, Vec3(2, 1, 0)},
                                       {1, Vec3(0, 0, 0.5)}, {1, Vec3(0, 0, -0.5)}};
  const Instrument blade(chain, {{.name = "blade", .points = corners, .radius = 0.0}});
  auto guard = guard_of(mesh, blade, {.margin = 1.5});
  std::vector<double> q{0.0};
  for (int i = 0; i < 400; ++i) {
    const InstrumentStep step = guard.step(q, std::vector<double>{0.01});
    ASSERT_TRUE(step.ok()) << step.reason();
    q = moved(q, step);
    ASSERT_GE(clearance_of(blade, *mesh, q), 1.498 - 3.0 * guard.tolerance());
  }
  EXPECT_NEAR(2.0 * std::sin(q[0]), 1.5, 1e-3) << "it turned until its edge was at the margin";
}

TEST(InstrumentConstraint, RefusesWhatIsNoInput) {
  auto guard = guard_of(mesh_of("cube"), psm_above(), {.period = 0.05});
  const std::vector<double> q = straight_down(20.0);
  std::vector<double> bad = q;
  bad[3] = test::nan;
  const std::vector<double> few(5, 0.0);
  EXPECT_EQ(guard.step(few, Twist{}).status, Status::invalid_input);
  EXPECT_EQ(guard.step(bad, Twist{}).status, Status::invalid_input);
  EXPECT_EQ(guard.step(q, {.linear = Vec3(0, test::nan, 0)}).status, Status::invalid_input);
  EXPECT_EQ(guard.step(q, {.angular = Vec3(0, test::infinity, 0)}).status, Status::invalid_input);
  EXPECT_EQ(guard.step(q, few).status, Status::invalid_input);
  EXPECT_EQ(guard.step(q, q, std::vector<double>(6, 0.0)).status, Status::invalid_input);
  EXPECT_EQ(guard.prove(q, bad).status, Status::invalid_input);
  EXPECT_EQ(guard.step(q, Twist{}).status, Status::free) << "and goes on";
}

TEST(InstrumentConstraint, SaysWhatIsWrongWithItsParts) {
  const auto mesh = mesh_of("cube");
  const auto with = [&](const InstrumentOptions& options) {
    return error_of([&] { guard_of(mesh, psm_above(), options); });
  };
  EXPECT_CONTAINS(with({.margin = 0.0}), "margin");
  EXPECT_CONTAINS(with({.margin = 0.2, .band = 0.2}), "band");
  EXPECT_CONTAINS(with({.margin = 1e-12, .band = 1e-13}), "rounding");
  EXPECT_CONTAINS(with({.period = 0.0}), "period");
  EXPECT_CONTAINS(with({.damping = test::nan}), "damping");
  const auto other = mesh_of("gear");
  const auto of_other = [&] {
    InstrumentConstraint(mesh, std::make_shared<WideBvh>(other), psm_above(),
                         make_solver("active_set"), {});
  };
  EXPECT_CONTAINS(error_of(of_other), "another mesh");
  const auto no_solver = [&] {
    InstrumentConstraint(mesh, std::make_shared<WideBvh>(mesh), psm_above(), nullptr, {});
  };
  EXPECT_CONTAINS(error_of(no_solver), "solver");
}

TEST(InstrumentConstraint, ABandForTheLimitsOfItsJointsHoldsEveryBendAtFullSpeed) {
  const Instrument instrument = psm();
  const double band = recommended_band(instrument, 1e-3, 0.0);
  Random random(8);
  double most = 0.0;
  for (int i = 0; i < test::trials(20'000); ++i) {
    std::vector<double> q(6);
    std::vector<double> dq(6);
    for (int k = 1; k <= 6; ++k) {
      const auto j = static_cast<std::size_t>(k - 1);
      const JointLimits& limits = instrument.chain().joint(k).limits;
      q[j] = random.uniform(limits.lower, limits.upper);
      dq[j] = limits.velocity * 1e-3 * (random.below(2) == 0 ? 1.0 : -1.0);
    }
    const ChainState chain = test::state_of(instrument.chain(), q);
    for (const LinkPoint& point : instrument.points()) {
      const Vec3 at = chain.at(point.link, point.position);
      most = std::max(most, motion_bounds(chain, dq, point.link, at).bend / 8.0);
    }
  }
  EXPECT_LE(most, band);
  EXPECT_GT(most, 0.02 * band) << "lengths of ways are added up, folded or not";
  EXPECT_EQ(recommended_band(instrument, 1e-3, 1.0), 1.0);
  // The point lies on the axis of a joint without limits.
  const Instrument unlimited(Chain({Joint{}}), {{.points = {{1, Vec3::Zero()}}, .radius = 1.0}});
  EXPECT_EQ(recommended_band(unlimited, 1e-3), test::infinity);
}

}  // namespace
}  // namespace keepout
