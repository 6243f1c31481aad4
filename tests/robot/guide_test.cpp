// SPDX-License-Identifier: BSD-3-Clause
#include "guards.h"
#include "guide_kinematics.h"
#include "keepout/error.h"
#include "stub_solver.h"

namespace keepout {
namespace {

const LinkPoint wrist{4, Vec3::Zero()};
const LinkPoint jaw_tip{6, Vec3(0, 10.2, 0)};  // of the psm

/// A psm 120 above a mesh, and its guard.
struct Bench {
  explicit Bench(const char* shape = "gear")
      : mesh(mesh_of(shape)),
        instrument(psm({Vec3(30, 10, 120), Mat3::Identity()})),
        guard(guard_of(mesh, instrument, {.period = 0.02, .check_sides = false})) {}

  ChainState at(const std::vector<double>& q) const {
    const ChainState state = test::state_of(instrument.chain(), q);
    return state;
  }

  std::shared_ptr<const Mesh> mesh;
  Instrument instrument;
  InstrumentConstraint guard;
};

/// Returns the largest excess of a guide on a step, in the true states of the chain.
double farthest_out(const Bench& bench, const Guide& guide, const std::vector<double>& q,
                    const InstrumentStep& step) {
  double most = -1e30;
  for (int s = 0; s <= 16; ++s) {
    const ChainState there = bench.at(keepout::moved(q, step, s / 16.0));
    most = std::max(most, guide.region().excess(guided_point(guide, there)));
  }
  return most;
}

// In the second cycle the solver does not converge on the first problem with the guide's row. The
// next problem lets the point use the band. This is a relaxation, although the point starts inside
// its region.
TEST(Guide, ThatLetsAPointUseItsBandIsReportedAsRelaxed) {
  constexpr double band = 0.01;
  for (const bool fails : {false, true}) {
    SCOPED_TRACE(fails);
    const auto solver = std::make_shared<ActiveSet>();
    solver->reserve(3, 200);
    Eigen::Index least_rows = 1000;
    bool is_due = false;
    const auto mesh = mesh_of(make_cube(20.0));
    InstrumentConstraint guard(
        mesh, std::make_shared<WideBvh>(mesh), free_ball(1.0),
        solver_that([&, solver](const StepProblem& problem, Solution& solution) {
          least_rows = std::min(least_rows, problem.rows.rows());
          if (problem.rows.rows() > least_rows && std::exchange(is_due, false)) {
            return SolveStatus::iteration_limit;
          }
          return solver->solve(problem, solution);
        }),
        {.damping = 1e-9, .orientation_weight = 0.0});
    const LinkPoint center{3, Vec3::Zero()};
    const Region above = Region::half_space(Vec3(0, 0, 400), Vec3::UnitZ());
    guard.set_guides({Guide::point("above", center, above).with_band(band)});
    const std::vector<double> at{0.0, 0.0, 400.05};
    ASSERT_EQ(guard.step(at, Twist{.linear = Vec3(0, 0, -0.1)}).status, Status::limited);
    is_due = fails;
    const InstrumentStep step = guard.step(at, Twist{.linear = Vec3(0, 0, -0.055)});
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_FALSE(is_due);
    EXPECT_NEAR(step.increment[2], fails ? -0.055 : -0.05, 1e-6);
    EXPECT_EQ(step.relaxation, fails ? Relaxation::guides : Relaxation::none);
  }
}

TEST(Guide, IsAboutWhatItSays) {
  const Bench bench;
  Random random(1);
  for (int i = 0; i < test::trials(300); ++i) {
    const std::vector<double> q = test::configuration(bench.instrument.chain(), random);
    const ChainState state = bench.at(q);
    const Vec3 center = state.at(4, Vec3(3.0 * random.direction()));
    const Guide shaft = Guide::remote_center("port", {0, Vec3::Zero()}, wrist, center, 0.5);
    const Vec3 along = state.at(4, Vec3::Zero()) - state.at(0, Vec3::Zero());
    const double share =
        std::clamp(along.dot(center - state.at(0, Vec3::Zero())) / along.squaredNorm(), 0.0, 1.0);
    const Vec3 nearest = state.at(0, Vec3::Zero()) + share * along;
    EXPECT_NEAR((guided_point(shaft, state) - nearest).norm(), 0.0, 1e-9);

    // If all three axes are within their angles, the rotation is at most `angle`.
    const Mat3 wanted = state.link(6).rotation;
    const double angle = random.uniform(0.01, 1.0);
    const std::vector<Guide> axes = Guide::orientation("hand", 6, wanted, angle);
    ASSERT_EQ(axes.size(), 3u);
    std::vector<double> other = q;
    for (double& number : other) number += random.uniform(-0.5, 0.5) * angle;
    const ChainState there = bench.at(other);
    const bool is_kept = std::all_of(axes.begin(), axes.end(), [&](const Guide& axis) {
      return axis.region().excess(guided_point(axis, there)) <= 0.0;
    });
    const double turn = Eigen::AngleAxisd(wanted.transpose() * there.link(6).rotation).angle();
    if (is_kept) {
      EXPECT_LE(turn, angle + 1e-9);
    }
    if (turn < 0.7 * angle) {
      EXPECT_TRUE(is_kept);
    }
  }
}

// Compares second differences on a fine grid with the bound that proofs use.
TEST(Guide, BoundsTheBendOfItsPlace) {
  const Bench bench;
  Random random(2);
  const Chain& chain = bench.instrument.chain();
  double largest = 0.0;
  for (int i = 0; i < test::trials(5000); ++i) {
    const std::vector<double> q = test::configuration(chain, random);
    const ChainState state = bench.at(q);
    const Vec3 center = state.at(4, Vec3(10.0 * random.direction()));
    const Guide guides[] = {Guide::point("tip", jaw_tip, Region::ball(center, 1.0)),
                            Guide::axis("axis", 6, random.direction(), random.direction(), 1.0)};
    std::vector<double> increment;
    for (int k = 1; k <= chain.size(); ++k) increment.push_back(random.uniform(-0.3, 0.3));
    for (const Guide& guide : guides) {
      const double bend = guided_bend(guide, state, increment, 0.0);
      Vec3 places[33];
      for (int s = 0; s <= 32; ++s) {
        std::vector<double> there = q;
        for (std::size_t k = 0; k < there.size(); ++k) there[k] += s / 32.0 * increment[k];
        places[s] = guided_point(guide, bench.at(there));
      }
      for (int s = 1; s < 32; ++s) {
        const double second = (places[s - 1] - 2.0 * places[s] + places[s + 1]).norm() * 32 * 32;
        ASSERT_LE(second, bend + 1e-8);
        largest = std::max(largest, second / (bend + 1e-6));
      }
    }
  }
  EXPECT_GT(largest, 0.5) << "the bound is of the size of what it bounds";
}

/// Moves and turns the jaw in all directions. Returns how often each guide limited the motion.
std::vector<int> wander(Bench& bench, const std::vector<Guide>& guides, std::vector<double> q,
                        int cycles, std::uint64_t seed) {
  bench.guard.set_guides(guides);
  Random random(seed);
  std::vector<int> held(guides.size(), 0);
  double way = 0.0;
  for (int i = 0; i < cycles; ++i) {
    const Vec3 linear = (i % 60 < 30 ? 1.0 : -1.0) * random.uniform(0.0, 2.0) *
                        (Vec3(std::cos(i / 60), std::sin(i / 60), -0.7) + 0.3 * random.direction());
    const Vec3 angular = random.uniform(0.0, 0.1) * random.direction();
    const InstrumentStep step = bench.guard.step(q, {.linear = linear, .angular = angular});
    EXPECT_TRUE(step.ok()) << step.reason();
    EXPECT_EQ(step.guides.size(), guides.size());
    EXPECT_EQ(step.relaxation, Relaxation::none);
    if (!step.ok() || step.guides.size() != guides.size()) return held;
    for (std::size_t g = 0; g < guides.size(); ++g) {
      const double out = farthest_out(bench, guides[g], q, step);
      EXPECT_LE(out, guides[g].band() + 3e-9) << guides[g].name() << " in cycle " << i;
      held[g] += step.guides[g].limits ? 1 : 0;
    }
    for (std::size_t k = 0; k < q.size(); ++k) {
      q[k] += step.increment[k];
      way += std::abs(step.increment[k]);
    }
  }
  EXPECT_GT(way, 0.01 * cycles) << "and yet it moves";
  return held;
}

TEST(Guide, IsNeverLeftByMoreThanItsBand) {
  const std::vector<double> q{0.1, -0.1, 60.0, 0.2, 0.1, -0.2};
  const Bench at_start;
  const ChainState state = at_start.at(q);
  const Vec3 at = state.at(jaw_tip.link, jaw_tip.position);
  const Vec3 way = state.at(4, Vec3::Zero()) - state.at(0, Vec3::Zero());
  const Vec3 axis = state.link(6).rotation.col(1);
  const Vec3 port = state.at(0, Vec3::Zero()) + 0.4 * way;
  const std::vector<std::vector<Guide>> sets{
      {Guide::point("corridor", jaw_tip, Region::slab(at, Vec3(1, 0.2, 0), 1.0))},
      {Guide::point("path", jaw_tip, Region::tube(at, Vec3(1, 1, 0.3), 0.5))},
      {Guide::point("above", jaw_tip, Region::half_space(at - Vec3(0, 0, 1), Vec3::UnitZ()))},
      {Guide::axis("axis", 6, Vec3::UnitY(), axis, 0.2)},
      {Guide::remote_center("trocar", {0, Vec3(1, 0, 0)}, wrist, port, 1.0)},
      Guide::orientation("hand", 6, state.link(6).rotation, 0.1),
      {Guide::point("corridor", jaw_tip, Region::slab(at, Vec3(1, 0.2, 0), 1.0)),
       Guide::point("not too far", jaw_tip, Region::ball(at, 5.0)),
       Guide::axis("axis", 6, Vec3::UnitY(), axis, 0.3)}};
  for (std::size_t i = 0; i < sets.size(); ++i) {
    Bench bench;
    const std::vector<int> held = wander(bench, sets[i], q, test::trials(1500), i + 1);
    for (std::size_t g = 0; g < held.size(); ++g) {
      EXPECT_GT(held[g], test::trials(20)) << sets[i][g].name();
    }
  }
}

TEST(Guide, LeadsBackWhatIsOut) {
  Bench bench;
  std::vector<double> q{0.0, 0.0, 60.0, 0.0, 0.0, 0.0};
  const Vec3 at = bench.at(q).at(jaw_tip.link, jaw_tip.position);
  const Guide guide =
      Guide::point("corridor", jaw_tip, Region::slab(at + Vec3(3, 0, 0), Vec3::UnitX(), 1.0));
  bench.guard.set_guides({guide});
  double last = 2.0;
  int cycles = 0;
  for (; last > guide.band() && cycles < 100; ++cycles) {
    const InstrumentStep step = bench.guard.step(q, {.linear = Vec3(-0.2, 0, 0)});
    ASSERT_EQ(step.status, Status::recovering) << step.reason();
    ASSERT_NEAR(step.guides[0].excess, last, 1e-9);
    EXPECT_FALSE(step.guides[0].relaxed);
    q = keepout::moved(q, step);
    const double now = guide.region().excess(guided_point(guide, bench.at(q)));
    ASSERT_LE(now, last + guide.band());
    last = now;
  }
  EXPECT_LT(cycles, 60);
}

TEST(Guide, GivesWayWithAWordOnItWhereOthersContradict) {
  Bench bench;
  std::vector<double> q{0.0, 0.0, 60.0, 0.0, 0.0, 0.0};
  const Vec3 at = bench.at(q).at(jaw_tip.link, jaw_tip.position);
  // The tip is between the two planes, outside both regions.
  bench.guard.set_guides(
      {Guide::point("left", jaw_tip, Region::half_space(at - Vec3(1, 0, 0), -Vec3::UnitX())),
       Guide::point("right", jaw_tip, Region::half_space(at + Vec3(1, 0, 0), Vec3::UnitX()))});
  for (int i = 0; i < 50; ++i) {
    const InstrumentStep step = bench.guard.step(q, {.linear = Vec3(0.3, 0.3, 0.1)});
    ASSERT_EQ(step.status, Status::recovering) << step.reason();
    EXPECT_EQ(step.relaxation, Relaxation::guides);
    EXPECT_TRUE(step.guides[0].relaxed && step.guides[1].relaxed);
    q = keepout::moved(q, step);
  }
  const Vec3 moved = bench.at(q).at(jaw_tip.link, jaw_tip.position) - at;
  EXPECT_LE(std::abs(moved.x()), 0.01) << "neither gets worse";
  EXPECT_GT(moved.y(), 5.0) << "along both it moves";
}

// The point starts outside, enters the band, and is pushed out again: it must stay within the band.
TEST(Guide, KeepsWhatIsWithinItsBandAgain) {
  Random random(7);
  int back = 0;
  for (int i = 0; i < test::trials(300); ++i) {
    Bench bench;
    std::vector<double> q{0.1, -0.1, 60.0, 0.2, 0.1, -0.2};
    const Vec3 at = bench.at(q).at(jaw_tip.link, jaw_tip.position);
    const double out = random.uniform(0.0, 0.01);
    const Guide guide =
        Guide::point("ball", jaw_tip, Region::ball(at + (1.0 + out) * random.direction(), 1.0));
    bench.guard.set_guides({guide});
    for (int cycle = 0; cycle < 8; ++cycle) {
      const InstrumentStep step =
          bench.guard.step(q, {.linear = random.uniform(0.0, 8.0) * random.direction(),
                               .angular = 0.1 * random.direction()});
      if (!step.ok()) continue;
      if (step.guides[0].excess <= guide.band()) {
        ASSERT_LE(farthest_out(bench, guide, q, step), guide.band() + 3e-9);
        back += step.guides[0].excess > 0.0 ? 1 : 0;
      }
      q = keepout::moved(q, step);
    }
  }
  EXPECT_GT(back, test::trials(100));
}

// The regions lie inside the mesh. Mesh avoidance has priority, so the step relaxes the guides.
TEST(Guide, NeverLeadsIntoTheMesh) {
  Bench bench("cube");
  std::vector<double> q{0.0, 0.0, 60.0, 0.0, 0.0, 0.0};
  const Vec3 center = 0.5 * (bench.mesh->bounds().low + bench.mesh->bounds().high);
  const Vec3 at = bench.at(q).at(jaw_tip.link, jaw_tip.position);
  bench.guard.set_guides({Guide::point("in", jaw_tip, Region::tube(center, center - at, 0.5)),
                          Guide::point("deep", jaw_tip, Region::ball(center, 0.1))});
  InstrumentStep step;
  for (int i = 0; i < test::trials(1000); ++i) {
    step = bench.guard.step(q, {.linear = 0.5 * (center - at).normalized()});
    ASSERT_TRUE(step.ok()) << step.reason() << " in cycle " << i;
    ASSERT_TRUE(!step.distance || *step.distance >= 0.198 - 1e-8) << i;
    q = keepout::moved(q, step);
  }
  EXPECT_NEAR(step.distance.value_or(1.0), 0.2, 0.003) << "it came as near as it may";
  EXPECT_EQ(step.relaxation, Relaxation::guides);
  EXPECT_TRUE(step.guides[1].relaxed);
}

TEST(Guide, IsKeptWhenTheMeshIsFollowed) {
  Bench bench;
  std::vector<double> q{0.1, -0.1, 60.0, 0.2, 0.1, -0.2};
  const Vec3 at = bench.at(q).at(jaw_tip.link, jaw_tip.position);
  const Guide guide = Guide::point("ball", jaw_tip, Region::ball(at, 0.5));
  bench.guard.set_guides({guide});
  const Twist aside{.linear = Vec3(1.0, 0.0, 0.0)};
  const auto tree = std::make_shared<WideBvh>(bench.mesh);
  bench.guard.follow(bench.mesh, tree);
  const auto other = mesh_of("gear");
  tree->refit(other);
  const InstrumentStep none = bench.guard.step(q, aside);
  EXPECT_EQ(none.status, Status::mesh_changed);
  EXPECT_TRUE(none.increment.empty());
  bench.guard.follow(other, tree);
  for (int i = 0; i < 5; ++i) {
    const InstrumentStep step = bench.guard.step(q, aside);
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_LE(farthest_out(bench, guide, q, step), guide.band() + 3e-9);
    EXPECT_TRUE(step.limits.has(Limit::guide));
    q = keepout::moved(q, step);
  }
}

TEST(Guide, RefusesWhatIsNone) {
  Bench bench;
  EXPECT_THROW(Guide::axis("a", 6, Vec3::Zero(), Vec3::UnitX(), 0.1), Error);
  EXPECT_THROW(Guide::axis("a", 6, Vec3::UnitX(), Vec3::UnitX(), 4.0), Error);
  EXPECT_THROW(Guide::axis("a", -1, Vec3::UnitX(), Vec3::UnitX(), 1.0), Error);
  EXPECT_THROW(Guide::orientation("a", 6, 2.0 * Mat3::Identity(), 1.0), Error);
  const Guide guide = Guide::point("a", jaw_tip, Region::ball(Vec3::Zero(), 1.0));
  EXPECT_THROW(guide.with_band(0.0), Error);
  EXPECT_THROW(bench.guard.set_guides({guide.with_band(1e-12)}), Error);
  EXPECT_EQ(guide.with_band(0.5).band(), 0.5);
  const Guide axis = Guide::axis("a", 6, Vec3::UnitX(), Vec3::UnitX(), 0.5);
  EXPECT_THROW(bench.guard.set_guides({axis.with_band(1e-15)}), Error) << "lost in rounding";
  EXPECT_THROW(bench.guard.set_guides(std::vector<Guide>(17, guide)), Error);
  EXPECT_THROW(bench.guard.set_guides({Guide::point("a tip's", guide.region())}), Error);
  EXPECT_THROW(bench.guard.set_guides({Guide::point("a", {7, Vec3::Zero()}, guide.region())}),
               Error);
}

// Motions whose guided point is inside its region at both ends, and outside in between.

/// An instrument under one guide, far from a wall.
struct Guided {
  Guided(Instrument instrument, const Guide& its_guide, const InstrumentCapacity& capacity = {})
      : guide(its_guide),
        mesh(wall(1e3)),
        guard(guard_of(mesh, std::move(instrument), {.damping = 0.0, .check_sides = false},
                       capacity)) {
    guard.set_guides({guide});
  }

  /// Returns by how much the guided point leaves its region on q + s dq, at 65 poses.
  double farthest_out(const std::vector<double>& q, std::span<const double> dq) const {
    double most = -1e30;
    for (int s = 0; s <= 64; ++s) {
      std::vector<double> there = q;
      for (std::size_t k = 0; k < dq.size(); ++k) there[k] += s / 64.0 * dq[k];
      const ChainState chain = test::state_of(guard.instrument().chain(), there);
      most = std::max(most, guide.region().excess(guided_point(guide, chain)));
    }
    return most;
  }

  Guide guide;
  std::shared_ptr<const Mesh> mesh;
  InstrumentConstraint guard;
};

// The ends of the shaft move on straight lines. The shaft passes through the remote center at the
// start and at the end of the motion. In between, the guided point slides from one end of the shaft
// to the other. It misses the center by a quarter of the sideways displacement of both ends.
TEST(GuidedPath, OfAShaftThatSlidesIsKeptInBetween) {
  constexpr double length = 10.0;
  const Joint insertion{.kind = JointKind::prismatic, .axis = Vec3::UnitX()};
  const Joint sideways{.kind = JointKind::prismatic, .axis = Vec3::UnitY()};
  const Instrument instrument(Chain({insertion, sideways, sideways}),
                              {{"end", {{3, Vec3(length, 0, 0)}}, 0.5}});
  const Guide port =
      Guide::remote_center("port", {2, Vec3::Zero()}, {3, Vec3(length, 0, 0)}, Vec3::Zero(), 0.1);
  const std::vector<double> q{0.0, 0.0, 1.0};
  for (const double share : {1.0, 0.5, 0.1}) {
    SCOPED_TRACE(share);
    Guided shaft(instrument, port);
    const std::vector<double> desired{-share * length, share, -2.0 * share};
    const InstrumentStep step = shaft.guard.step(q, desired);
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_LE(shaft.farthest_out(q, step.increment), port.band() + 3.0 * shaft.guard.tolerance());
    EXPECT_LT(step.increment[0], -0.01) << "the shaft moves";
  }
}

// For one revolute joint the second-derivative bound is exact. `missing` is the excess beyond the
// band in the middle of the arc, as a fraction of the sagitta.
TEST(GuidedPath, OfAPointThatTurnsIsKeptInTheMiddleOfItsArc) {
  constexpr double lever = 100.0;
  constexpr double turn = 0.04;
  const double sagitta = lever * (1.0 - std::cos(0.5 * turn));
  const LinkPoint point{1, Vec3(lever, 0, 0)};
  for (const double missing : {0.9, 0.45, 0.3, 0.01, -1e-3}) {
    SCOPED_TRACE(missing);
    const double band = 0.002;
    const Vec3 limit((lever - band - missing * sagitta), 0, 0);
    const Guide guide =
        Guide::point("limit", point, Region::half_space(limit, -Vec3::UnitX())).with_band(band);
    Guided arm({Chain({{.kind = JointKind::revolute}}), {{"point", {point}, 0.5}}}, guide);
    const std::vector<double> q{-0.5 * turn};
    const InstrumentStep step = arm.guard.step(q, std::vector<double>{turn});
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_LE(arm.farthest_out(q, step.increment), band + 3.0 * arm.guard.tolerance());
    EXPECT_EQ(step.increment[0] > (1.0 - 1e-9) * turn, missing < 0.0)
        << "the whole motion is made if it is clear";
  }
}

// The only body overlaps the wall and cannot retreat, so its pair is dropped. Otherwise the
// judgement of the pair would notice the end of the budget.
TEST(GuidedPath, IsProvedOrNotMadeWhereverTheBudgetEnds) {
  constexpr double lever = 100.0;
  const double band = 0.002;
  const LinkPoint point{1, Vec3(lever, 0, 0)};
  const Vec3 limit(lever - 0.01, 0, 0);  // the motion from -0.02 to 0.02 leaves it in the middle
  const Guide guide =
      Guide::point("limit", point, Region::half_space(limit, -Vec3::UnitX())).with_band(band);
  const Body fixed{"fixed", {{0, Vec3(1e3 - 0.3, 0, 0)}}, 0.5};
  const std::vector<double> q{-0.02};
  int made = 0, ended = 0;
  for (std::uint64_t units = 1; units < 3000; ++units) {
    SCOPED_TRACE(units);
    Guided arm({Chain({{.kind = JointKind::revolute}}), {fixed}}, guide, {.work_units = units});
    const InstrumentStep step = arm.guard.step(q, std::vector<double>{0.04});
    EXPECT_LE(arm.farthest_out(q, step.increment), band + 3.0 * arm.guard.tolerance());
    (step.ok() ? made : ended) += 1;
  }
  EXPECT_GT(made, 10);
  EXPECT_GT(ended, 10);
}

}  // namespace
}  // namespace keepout
