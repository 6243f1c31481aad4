// SPDX-License-Identifier: BSD-3-Clause
// InstrumentStep::limits names every cause of a limited motion, and only causes.
#include <array>

#include "brute_force.h"
#include "guards.h"
#include "near_set.h"

namespace keepout {
namespace {

struct Removed {
  bool mesh = false;
  bool guides = false;
  bool positions = false;
  bool velocities = false;
};

/// Returns the psm above the origin without some limits of its joints.
Instrument robot_without(const Removed& removed) {
  const Instrument whole = psm({Vec3(30, 10, 120), Mat3::Identity()});
  std::vector<Joint> joints;
  for (int k = 1; k <= whole.chain().size(); ++k) {
    Joint joint = whole.chain().joint(k);
    if (removed.positions) joint.limits.lower = -test::infinity;
    if (removed.positions) joint.limits.upper = test::infinity;
    if (removed.velocities) joint.limits.velocity = test::infinity;
    joints.push_back(joint);
  }
  return {Chain(std::move(joints), whole.chain().base(), whole.chain().flange()),
          {whole.bodies().begin(), whole.bodies().end()}};
}

InstrumentConstraint guard_without(const Removed& removed, const std::vector<Guide>& guides) {
  const Surface surface = make_shape("gear");
  const auto mesh = mesh_of(removed.mesh ? moved(surface, Vec3(0, 0, -2000)) : surface);
  auto guard = guard_of(mesh, robot_without(removed), {.period = 0.02, .check_sides = false});
  if (!removed.guides) guard.set_guides(guides);
  return guard;
}

double difference(const InstrumentStep& one, const InstrumentStep& other) {
  if (one.increment.size() != other.increment.size()) return test::infinity;
  double most = 0.0;
  for (std::size_t k = 0; k < one.increment.size(); ++k) {
    most = std::max(most, std::abs(one.increment[k] - other.increment[k]));
  }
  return most;
}

/// Returns true if the position limit and the velocity limit of a joint allow the same increment,
/// to within rounding. Without one of the two limits, the other one gives the same motion.
bool is_tied(const Chain& chain, const std::vector<double>& q, const InstrumentStep& step,
             double period) {
  for (std::size_t k = 0; k < step.increment.size(); ++k) {
    const JointLimits& limits = chain.joint(static_cast<int>(k) + 1).limits;
    const double room = step.increment[k] > 0.0 ? limits.upper - q[k] : q[k] - limits.lower;
    if (std::abs(room - limits.velocity * period) < 1e-12) return true;
  }
  return false;
}

TEST(Limits, NameEveryCauseAndOnlyCauses) {
  const LinkPoint jaw{6, Vec3(0, 10.2, 0)};
  const std::vector<double> start{0.1, -0.1, 60.0, 0.2, 0.1, -0.2};
  const Instrument robot = robot_without({});
  const ChainState state = test::state_of(robot.chain(), start);
  const std::vector<Guide> guides{Guide::point(
      "corridor", jaw, Region::slab(state.at(jaw.link, jaw.position), Vec3(1, 0.2, 0), 8.0))};
  struct Cause {
    Limit limit;
    InstrumentConstraint without;
  };
  std::array<Cause, 4> causes{
      Cause{Limit::mesh, guard_without({.mesh = true}, guides)},
      Cause{Limit::guide, guard_without({.guides = true}, guides)},
      Cause{Limit::joint_position, guard_without({.positions = true}, guides)},
      Cause{Limit::joint_velocity, guard_without({.velocities = true}, guides)}};
  InstrumentConstraint guard = guard_without({}, guides);
  InstrumentConstraint alone = guard_without({true, true, true, true}, guides);
  // With --gtest_shuffle --gtest_repeat=10, each repetition draws other motions.
  Random random(3u + static_cast<unsigned>(testing::UnitTest::GetInstance()->random_seed()));
  std::array<int, 4> seen{};
  int free = 0;
  std::vector<double> q = start;
  for (int i = 0; i < test::trials(100'000); ++i) {
    if (i % 200 == 0) {
      q = start;
      guard.forget();
    }
    const double speed = i / 200 % 3 == 0 ? 6.0 : 1.0;
    const Vec3 along(std::cos(i / 200), std::sin(i / 200), -0.8);
    const Twist desired{.linear = speed * (0.5 * along + 0.5 * random.direction()),
                        .angular = speed * 0.05 * random.direction()};
    const InstrumentStep step = guard.step(q, desired);
    if (step.status == Status::limited) {
      ASSERT_FALSE(step.limits.empty()) << i;
    }
    if (step.status == Status::free) {
      ASSERT_TRUE(step.limits.empty()) << i;
      ASSERT_LT(difference(step, alone.step(q, desired)), 1e-9) << i;
      ++free;
    }
    ASSERT_EQ(step.limits.has(Limit::truncated), step.status == Status::truncated) << i;
    for (std::size_t c = 0; c < causes.size(); ++c) {
      if (!step.limits.has(causes[c].limit)) continue;
      ++seen[c];
      if (is_tied(guard.instrument().chain(), q, step, guard.options().period)) continue;
      causes[c].without.forget();
      ASSERT_GT(difference(step, causes[c].without.step(q, desired)), 0.0)
          << name(causes[c].limit) << " does not limit step " << i;
    }
    q = moved(q, step);
  }
  EXPECT_GT(free, test::trials(3000));
  for (std::size_t c = 0; c < causes.size(); ++c) {
    EXPECT_GT(seen[c], test::trials(300)) << name(causes[c].limit);
  }
}

TEST(Limits, OfAnArmFarFromEveryMeshAreThoseOfItsJoints) {
  InstrumentConstraint guard = guard_without({.mesh = true}, {});
  Random random(5);
  std::vector<double> q{0, 0, 60, 0, 0, 0};
  int limited = 0;
  for (int i = 0; i < test::trials(20'000); ++i) {
    if (i % 200 == 0) q = test::configuration(guard.instrument().chain(), random);
    const InstrumentStep step =
        guard.step(q, {.linear = 8.0 * random.direction(), .angular = 0.3 * random.direction()});
    ASSERT_TRUE(step.ok());
    ASSERT_FALSE(step.limits.has(Limit::mesh)) << i;
    ASSERT_FALSE(step.limits.has(Limit::guide)) << i;
    limited += step.status == Status::limited ? 1 : 0;
    q = moved(q, step);
  }
  EXPECT_GT(limited, test::trials(2000));
}

// A stretched arm cannot move its flange inwards.
TEST(Limits, NameASingularPose) {
  const Surface far{{Vec3(0, 0, 2000), Vec3(100, 0, 2000), Vec3(0, 100, 2000)}, {{0, 1, 2}}};
  const auto mesh = mesh_of(far);
  std::vector<Joint> joints(3);
  for (int k : {1, 2}) joints[static_cast<std::size_t>(k)].origin.position = Vec3(100, 0, 0);
  auto guard =
      guard_of(mesh, {Chain(joints, {}, {Vec3(100, 0, 0)}), {{"tip", {{3, Vec3(100, 0, 0)}}, 1.0}}},
               {.orientation_weight = 0.0});
  const std::vector<double> q{0.0, 0.0, 0.0};
  const InstrumentStep inwards = guard.step(q, {.linear = Vec3(-1, 0, 0)});
  EXPECT_EQ(inwards.status, Status::limited);
  Limits singularity;
  singularity.add(Limit::singularity);
  EXPECT_EQ(inwards.limits, singularity);
  const InstrumentStep aside = guard.step(q, {.linear = Vec3(0, 1, 0)});
  EXPECT_EQ(aside.status, Status::free);
  EXPECT_TRUE(aside.limits.empty());
}

TEST(Limits, OfAnIllPosedTaskNameNoGuide) {
  const auto mesh = mesh_of(make_cube(2.0));
  auto guard =
      guard_of(mesh, seven_joint_arm({Vec3(0, 0, 2000), Mat3::Identity()}), {.damping = 0.0});
  for (const double speed : {0.0, 1e-9}) {
    guard.place(0, {}, {.linear = Vec3(speed, 0, 0)});
    const InstrumentStep step = guard.step(std::vector<double>(7, 0.3), {.linear = Vec3(1, 0, 0)});
    EXPECT_EQ(step.status, Status::ill_posed);
    EXPECT_TRUE(step.limits.empty());
  }
}

TEST(Limits, NameAJointThatStartsOutside) {
  InstrumentConstraint guard = guard_without({.mesh = true}, {});
  std::vector<double> q{0, 0, 60, 0, 0, 0};
  EXPECT_FALSE(guard.step(q, Twist{}).limits.has(Limit::joints_outside));
  q[2] = guard.instrument().chain().joint(3).limits.upper + 1.0;
  const InstrumentStep still = guard.step(q, Twist{});
  EXPECT_EQ(still.status, Status::free);
  EXPECT_CONTAINS(std::string(still.reason()), "outside its position limits");
  const InstrumentStep step = guard.step(q, {.linear = Vec3(0, 0, -1)});
  EXPECT_TRUE(step.ok());
  EXPECT_TRUE(step.limits.has(Limit::joints_outside));
  EXPECT_LE(step.increment[2], 0.0);
}

TEST(Limits, TellASpentBudgetFromASmallStore) {
  const auto mesh = mesh_of(make_cube(2.0));
  const auto status = [&](const InstrumentCapacity& capacity, double speed = 0.0) {
    auto guard = guard_of(mesh, free_ball(1.0), {.check_sides = false}, capacity);
    guard.place(0, {}, {.linear = Vec3(0, 0, speed)});
    return guard.step(std::vector<double>{0.0, 0.0, 51.3}, {.linear = Vec3(0, 0, -5)});
  };
  const InstrumentStep spent = status({.work_units = 20});
  EXPECT_EQ(spent.status, Status::out_of_budget) << spent.reason();
  EXPECT_TRUE(spent.limits.has(Limit::budget));
  EXPECT_FALSE(spent.limits.has(Limit::capacity) || spent.limits.has(Limit::mesh));
  const InstrumentStep small = status({.triangles = 1});
  EXPECT_EQ(small.status, Status::over_capacity) << small.reason();
  EXPECT_TRUE(small.limits.has(Limit::capacity));
  EXPECT_FALSE(small.limits.has(Limit::budget) || small.limits.has(Limit::mesh));
  const InstrumentStep moving = status({.triangles = 1}, -1.0);
  EXPECT_TRUE(moving.limits.has(Limit::capacity)) << name(moving.status);
}

// The first search for triangles exceeds the capacity; a second one does not. The budget may then
// end during the inside/outside classification of the ball.
TEST(Limits, TellASpentBudgetFromASearchThatWasTooWide) {
  const auto mesh = mesh_of(make_cube(2.0));
  const auto index = std::make_shared<WideBvh>(mesh);
  std::size_t all = 0;
  const auto status = [&](std::size_t work_units) {
    InstrumentConstraint guard(mesh, index, free_ball(1.0), std::make_unique<ActiveSet>(),
                               {.margin = 5.0}, {.triangles = 80, .work_units = work_units});
    const InstrumentStep step =
        guard.step(std::vector<double>{0.0, 0.0, 55.5}, {.linear = Vec3(0, 0, -0.01)});
    all = guard.work_units();
    return step.status;
  };
  ASSERT_TRUE(is_ok(status(Budget::unlimited)));
  int spent = 0;
  for (std::size_t work_units = 1, most = all; work_units <= most; work_units += 3) {
    const Status ended = status(work_units);
    EXPECT_NE(ended, Status::over_capacity) << work_units;
    spent += ended == Status::out_of_budget ? 1 : 0;
  }
  EXPECT_GT(spent, 10);
}

// The work budget or the capacity of an instrument's cycle runs out at an arbitrary point.

/// An arm with two revolute joints beside a cube whose corners are at 50. The ball at its end
/// swings across the cube's top, and would hit it.
struct Swing {
  explicit Swing(const InstrumentCapacity& capacity)
      : mesh(mesh_of(make_cube(50.0))),
        guard(guard_of(
            mesh,
            {Chain({{.axis = Vec3::UnitZ()}, {.origin = {Vec3(60, 0, 0)}, .axis = Vec3::UnitY()}},
                   {Vec3(-120, 0, 70)}),
             {{"shaft", {{1, Vec3::Zero()}, {2, Vec3::Zero()}}, 2.0},
              {"ball", {{2, Vec3(40, 0, 0)}}, 3.0}}},
            {.check_sides = false}, capacity)) {}

  /// Fails unless start + s dq is clear for s in [0, 1].
  void expect_clear(std::span<const double> dq, double share) const {
    const double kept = guard.options().margin - guard.options().band - 3.0 * guard.tolerance();
    constexpr int poses = 8;
    for (int s = 1; s <= poses; ++s) {
      std::vector<double> there = start;
      for (std::size_t k = 0; k < there.size(); ++k) there[k] += s * share / poses * dq[k];
      ASSERT_GE(clearance_of(guard.instrument(), *mesh, there), kept)
          << "at " << s << " of " << poses;
    }
  }

  /// Fails unless all certified parts of the motion are clear. Counts the motions with such a part.
  void expect_safe(int& counted) {
    const MotionProof proof = guard.prove(start, motion);
    expect_clear(motion, proof.fraction);
    const InstrumentStep step = guard.step(start, motion);
    ASSERT_TRUE(step.ok() || step.increment.empty()) << name(step.status);
    if (step.ok()) expect_clear(step.increment, 1.0);
    counted += proof.fraction > 0.0 && step.ok() ? 1 : 0;
  }

  const std::vector<double> start{-0.3, 0.1};
  const std::vector<double> motion{0.6, 0.45};
  std::shared_ptr<const Mesh> mesh;
  InstrumentConstraint guard;
};

TEST(SpentCapacity, NothingIsCertifiedThatIsNotClearWhereverTheWorkEnds) {
  Swing whole({});
  const MotionProof proof = whole.guard.prove(whole.start, whole.motion);
  ASSERT_GT(proof.fraction, 0.5);
  ASSERT_LT(proof.fraction, 1.0) << "the end is in the cube";
  std::size_t all = whole.guard.work_units();
  ASSERT_TRUE(whole.guard.step(whole.start, whole.motion).ok());
  all = std::max(all, whole.guard.work_units());
  ASSERT_GT(all, 50u);
  int certified = 0;
  const std::size_t stride = test::few_trials() ? 10 : 1;
  for (std::size_t work_units = 1; work_units <= all + 1; work_units += stride) {
    SCOPED_TRACE(testing::Message() << "work units " << work_units);
    Swing swing({.work_units = work_units});
    ASSERT_NO_FATAL_FAILURE(swing.expect_safe(certified));
  }
  EXPECT_GT(certified, test::trials(50));
}

TEST(SpentCapacity, NothingIsCertifiedThatIsNotClearHoweverFewTrianglesFit) {
  int certified = 0;
  for (std::size_t room = 1; room <= 64; ++room) {
    SCOPED_TRACE(testing::Message() << "room " << room);
    Swing swing({.triangles = room});
    ASSERT_NO_FATAL_FAILURE(swing.expect_safe(certified));
  }
  EXPECT_GT(certified, 10);
}

// A budget that ends during the refinement of a motion does not limit the motion.
TEST(SpentCapacity, IsNoLimitOfAMotionThatIsMadeAsAWhole) {
  const InstrumentOptions options{.margin = 2.0, .band = 1.0, .check_sides = false};
  Swing whole({});
  whole.guard.set_options(options);
  ASSERT_EQ(whole.guard.step(whole.start, whole.motion).status, Status::limited);
  const std::size_t all = whole.guard.work_units();
  int made_as_a_whole = 0;
  // The search has half of the units, which end in the refinement.
  for (std::size_t work_units = 1; work_units < 2 * all; ++work_units) {
    Swing swing({.work_units = work_units});
    swing.guard.set_options(options);
    const InstrumentStep step = swing.guard.step(swing.start, swing.motion);
    if (step.status != Status::limited) continue;
    ++made_as_a_whole;
    EXPECT_EQ(step.fraction, 1.0) << work_units;
    EXPECT_FALSE(step.limits.has(Limit::budget)) << work_units;
  }
  EXPECT_GT(made_as_a_whole, 10);
}

// The neighborhood has capacity for all triangles, the set for fewer.
TEST(SpentCapacity, ANearSetThatCannotHoldAllTrianglesKnowsNothing) {
  const auto mesh = mesh_of(make_cube(50.0));
  Budget budget;
  Neighborhood near(mesh, std::make_shared<WideBvh>(mesh), mesh->triangle_count(), budget);
  const std::vector<Vec3> core{Vec3::Zero()};
  for (std::size_t room = 1; room <= mesh->triangle_count(); ++room) {
    NearSet set(room, 0.0);
    const bool holds_all = room == mesh->triangle_count();
    ASSERT_EQ(set.gather(near, core, 200.0, budget), holds_all) << room;
    ASSERT_EQ(set.radius() >= 0.0, holds_all) << room;
  }
}

}  // namespace
}  // namespace keepout
