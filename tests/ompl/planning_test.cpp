// SPDX-License-Identifier: BSD-3-Clause
// What is plugged into OMPL, held to an independent oracle. The only test that sees OMPL's headers.
#include "keepout/ompl/planning.h"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "messages.h"
#include "states.h"
#include "trials.h"

namespace keepout::test::planning {
namespace {

constexpr double margin = 0.5;
constexpr double tolerance = 1e-6;  // far above 3 tau of shapes of this size

using SharedMesh = std::shared_ptr<const Mesh>;

std::shared_ptr<GuardPool> guards_of(const SharedMesh& mesh, std::size_t most = 2) {
  return std::make_shared<GuardPool>(
      [mesh] { return make_motion_constraint(mesh, {.options = {.margin = margin}}); }, most);
}

base::SpaceInformationPtr space_around(const Mesh& mesh) {
  ompl::msg::noOutputHandler();
  auto space = std::make_shared<base::RealVectorStateSpace>(3);
  base::RealVectorBounds bounds(3);
  for (unsigned int i = 0; i < 3; ++i) {
    bounds.setLow(i, mesh.bounds().low[i] - 10.0);
    bounds.setHigh(i, mesh.bounds().high[i] + 10.0);
  }
  space->setBounds(bounds);
  return std::make_shared<base::SpaceInformation>(space);
}

Vec3 any_place(const Mesh& mesh, Random& random) {
  Vec3 place;
  for (int i = 0; i < 3; ++i) {
    place[i] = random.uniform(mesh.bounds().low[i] - 9.0, mesh.bounds().high[i] + 9.0);
  }
  return place;
}

class PlanningOn : public testing::TestWithParam<const char*> {};

TEST_P(PlanningOn, TheValidatorAgreesWithTheOracleOnRandomMotions) {
  const SharedMesh mesh = mesh_of(GetParam());
  const base::SpaceInformationPtr space = space_around(*mesh);
  set_certified_checkers(space, guards_of(mesh));
  space->setup();
  oracle::SafetyOracle oracle(mesh);
  Random random(7);
  int valid = 0, invalid = 0;
  for (int i = 0; i < 800; ++i) {
    const Vec3 from = any_place(*mesh, random);
    // Short ones and long ones, of many pieces.
    const Vec3 to = i % 2 == 0 ? any_place(*mesh, random)
                               : Vec3(from + random.uniform(0.0, 8.0) * random.direction());
    const State a(space, from), b(space, to);
    if (!space->isValid(a.get())) continue;
    const State last(space, {0, 0, 0});
    std::pair<base::State*, double> last_valid{last.get(), -1.0};
    const oracle::Finding whole = oracle.check(from, to, margin - tolerance);
    if (space->checkMotion(a.get(), b.get(), last_valid)) {
      ++valid;
      EXPECT_FALSE(whole.below);
      EXPECT_EQ(last_valid.second, -1.0) << "is not to be touched";
      continue;
    }
    ++invalid;
    ASSERT_GE(last_valid.second, 0.0);
    ASSERT_LT(last_valid.second, 1.0);
    const Vec3 last_tip(last.values().data());
    EXPECT_LT((last_tip - (from + last_valid.second * (to - from))).norm(), 1e-9);
    EXPECT_FALSE(oracle.check(from, last_tip, margin - tolerance).below);
    EXPECT_TRUE(space->isValid(last.get()));
    if (space->satisfiesBounds(b.get())) {
      EXPECT_TRUE(oracle.check(from, to, margin + tolerance).below) << "refused without a reason";
      // To within a piece's 2^-8 the whole of what there is is proven.
      const Vec3 beyond = last_tip + (to - from).normalized() * 0.05;
      EXPECT_TRUE(oracle.check(from, beyond, margin + tolerance).below);
    }
  }
  EXPECT_GT(valid, 25);
  EXPECT_GT(invalid, 25);
}

INSTANTIATE_TEST_SUITE_P(Shapes, PlanningOn,
                         testing::Values("cube", "sphere", "gear", "thin_plates", "cortex",
                                         "star_bumps", "tunnel", "triangle_soup"),
                         by_name);

/// One plate of no thickness at z = 0, 100 wide.
SharedMesh sheet() { return mesh_of(make_flat_plate(10.0, 1)); }

TEST(Planning, SampledCheckingJumpsOverAPlateThatTheValidatorSees) {
  const SharedMesh mesh = sheet();
  const base::SpaceInformationPtr space = space_around(*mesh);
  const auto guards = guards_of(mesh);
  set_certified_checkers(space, guards);
  space->setup();
  const base::DiscreteMotionValidator sampled(space);
  const State above(space, {1, 2, 0.6}), below(space, {1, 2, -0.6});
  EXPECT_TRUE(sampled.checkMotion(above.get(), below.get()));
  EXPECT_FALSE(space->checkMotion(above.get(), below.get()));
}

TEST(Planning, AStateNearerThanTheMarginIsInvalid) {
  const SharedMesh mesh = sheet();
  const base::SpaceInformationPtr space = space_around(*mesh);
  set_certified_checkers(space, guards_of(mesh));
  space->setup();
  const auto is_valid = [&](double height) {
    const State state(space, {3, 4, height});
    return space->isValid(state.get());
  };
  EXPECT_TRUE(is_valid(margin));
  EXPECT_TRUE(is_valid(-margin)) << "an open mesh has no sides";
  EXPECT_FALSE(is_valid(margin - 1e-6));
  EXPECT_FALSE(is_valid(0.0));
  EXPECT_TRUE(is_valid(9.9));
  EXPECT_FALSE(is_valid(10.1)) << "out of bounds";
  EXPECT_FALSE(is_valid(test::nan));
}

TEST(Planning, WithSidesTheInsideIsInvalidAndWithoutItIsAnotherRoom) {
  const SharedMesh mesh = mesh_of("sphere");
  const base::SpaceInformationPtr space = space_around(*mesh);
  const State centre(space, {0, 0, 0});
  EXPECT_FALSE(make_state_validity_checker(space, guards_of(mesh))->isValid(centre.get()));
  const auto no_sides = std::make_shared<GuardPool>([mesh] {
    return make_motion_constraint(mesh,
                                  {.options = {.margin = margin}, .inside = Inside::taken_as_is});
  });
  EXPECT_TRUE(make_state_validity_checker(space, no_sides)->isValid(centre.get()));
  const State outside(space, {0, 0, 55});
  EXPECT_FALSE(make_motion_validator(space, no_sides)->checkMotion(centre.get(), outside.get()));
}

TEST(Planning, AMotionThatLeavesTheBoundsEndsAtItsStart) {
  const SharedMesh mesh = mesh_of("cube");
  const base::SpaceInformationPtr space = space_around(*mesh);
  const State from(space, {0, 0, 55}), to(space, {0, 0, 65});
  expect_invalid_from_the_start(*make_motion_validator(space, guards_of(mesh)), space, from, to);
}

TEST(Planning, AMotionOutOfAGuideIsInvalid) {
  const SharedMesh mesh = mesh_of("cube");
  const base::SpaceInformationPtr space = space_around(*mesh);
  const Vec3 start(0, 0, 55);
  const auto guards = std::make_shared<GuardPool>([mesh, start] {
    MotionConstraint guard = make_motion_constraint(mesh, {.options = {.margin = margin}});
    guard.set_guides({Guide::point("corridor", Region::slab(start, Vec3::UnitX(), 1.0))});
    return guard;
  });
  const State from(space, start), along(space, {0, 3, 55}), out(space, {3, 0, 55});
  const auto validator = make_motion_validator(space, guards);
  EXPECT_TRUE(validator->checkMotion(from.get(), along.get()));
  EXPECT_FALSE(validator->checkMotion(from.get(), out.get()));
  EXPECT_FALSE(make_state_validity_checker(space, guards)->isValid(out.get()));
}

TEST(Planning, NothingIsValidOnceTheMeshHasMoved) {
  const SharedMesh mesh = mesh_of("cube");
  const auto tree = std::make_shared<WideBvh>(mesh);
  const base::SpaceInformationPtr space = space_around(*mesh);
  const auto guards = std::make_shared<GuardPool>(
      [mesh, tree] { return make_motion_constraint(mesh, tree, {.options = {.margin = margin}}); },
      1);
  const State from(space, {0, 0, 55}), to(space, {0, 3, 55});
  const auto validator = make_motion_validator(space, guards);
  EXPECT_TRUE(validator->checkMotion(from.get(), to.get()));
  tree->refit(mesh_of("cube"));
  EXPECT_FALSE(validator->checkMotion(from.get(), to.get()));
  EXPECT_FALSE(make_state_validity_checker(space, guards)->isValid(from.get()));
}

TEST(Planning, ValidatorsCountAndMayBeCalledFromManyThreads) {
  const SharedMesh mesh = mesh_of("gear");
  const base::SpaceInformationPtr space = space_around(*mesh);
  const auto guards = guards_of(mesh, 2);  // fewer than threads: some wait
  const auto validator = make_motion_validator(space, guards);
  answers_of_threads(*validator, space, 4,
                     [&](Random& random) { return any_place(*mesh, random); });
  EXPECT_LE(guards->made(), 2u);
}

TEST(Planning, AWrongSpaceIsRefusedWithAWordOnWhatToDo) {
  const SharedMesh mesh = mesh_of("cube");
  const auto guards = guards_of(mesh);
  const auto make = [&](const base::StateSpacePtr& space) {
    return error_of(
        [&] { make_motion_validator(std::make_shared<base::SpaceInformation>(space), guards); });
  };
  const auto plane = std::make_shared<base::RealVectorStateSpace>(2);
  plane->setBounds(-1, 1);
  EXPECT_CONTAINS(make(plane), "RealVectorStateSpace>(3)");
  const auto poses = std::make_shared<base::SE3StateSpace>();
  EXPECT_CONTAINS(make(poses), "6 dimensions");
  const auto unbounded = std::make_shared<base::RealVectorStateSpace>(3);
  EXPECT_CONTAINS(make(unbounded), "setBounds");
  EXPECT_CONTAINS(
      error_of([&] { make_motion_validator(space_around(*mesh), std::shared_ptr<GuardPool>()); }),
      "GuardPool");
  EXPECT_THROW(set_certified_checkers(nullptr, guards), Error);
  EXPECT_THROW(make_sliding_connect(space_around(*mesh), guards, {.sliding_step = 6.0}), Error);
}

/// From one side of the cortex to the other.
std::vector<Coordinates> planned(std::uint64_t seed, bool slides, double range = 0.0) {
  const SharedMesh mesh = mesh_of("cortex");
  const base::SpaceInformationPtr space = space_around(*mesh);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  const auto guards = guards_of(mesh);
  set_certified_checkers(space, guards);
  space->setup();
  base::PlannerPtr planner = make_sliding_connect(space, guards);
  if (!slides) planner = std::make_shared<ompl::geometric::RRTConnect>(space);
  if (range > 0.0) planner->params().setParam("range", std::to_string(range));
  const State start(space, {-56, 0, 0}), goal(space, {56, 0, 0});
  const std::vector<Coordinates> path = solved(*planner, start, goal, 10.0);
  if (path.empty()) return path;
  base::PlannerData data(space);
  planner->getPlannerData(data);
  EXPECT_GE(data.numVertices(), 2u);
  EXPECT_EQ(data.numStartVertices(), 1u);
  return path;
}

TEST(Planning, BothPlannersFindPathsThatTheOraclePasses) {
  const SharedMesh mesh = mesh_of("cortex");
  oracle::SafetyOracle oracle(mesh);
  for (const bool slides : {false, true}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const std::vector<Coordinates> tips = planned(seed, slides);
      ASSERT_GE(tips.size(), 2u) << "not solved";
      EXPECT_EQ(tips.front(), (Coordinates{-56, 0, 0}));
      EXPECT_EQ(tips.back(), (Coordinates{56, 0, 0}));
      for (std::size_t i = 1; i < tips.size(); ++i) {
        const Vec3 from(tips[i - 1].data()), to(tips[i].data());
        EXPECT_FALSE(oracle.check(from, to, margin - tolerance).below);
      }
    }
  }
}

TEST(Planning, TheSameSeedPlansTheSameAndTheRangeIsHeeded) {
  EXPECT_EQ(planned(5, true), planned(5, true));
  EXPECT_NE(planned(5, true), planned(6, true));
  EXPECT_NE(planned(5, true), planned(5, true, 7.0));
}

TEST(Planning, AStartThatIsNotFreeEndsThePlanner) {
  const SharedMesh mesh = mesh_of("sphere");
  const base::SpaceInformationPtr space = space_around(*mesh);
  // Not even when the space's own checker lets everything pass.
  space->setStateValidityChecker([](const base::State*) { return true; });
  space->setup();
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  base::ScopedState<base::RealVectorStateSpace> inside(space), outside(space);
  for (unsigned int i = 0; i < 3; ++i) inside[i] = 0.0, outside[i] = 45.0;
  const auto status = [&](const auto& start, const auto& goal) {
    definition->clearSolutionPaths();
    definition->setStartAndGoalStates(start, goal);
    const auto planner = make_sliding_connect(space, guards_of(mesh));
    planner->setProblemDefinition(definition);
    planner->setup();
    return static_cast<base::PlannerStatus::StatusType>(planner->solve(1.0));
  };
  EXPECT_EQ(status(inside, outside), base::PlannerStatus::INVALID_START);
  EXPECT_EQ(status(outside, inside), base::PlannerStatus::INVALID_GOAL);
}

}  // namespace
}  // namespace keepout::test::planning
