// SPDX-License-Identifier: BSD-3-Clause
// Independent oracles judge the OMPL components for a tip and for a whole instrument.
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>

#include <thread>

#include "workplaces.h"

namespace keepout::test::planning {
namespace {

template <class Place>
class PlanningAt : public testing::Test {};
using Places = testing::Types<TipPlace, InstrumentPlace>;
TYPED_TEST_SUITE(PlanningAt, Places);

TYPED_TEST(PlanningAt, NothingIsCalledValidThatTheOracleFindsTooClose) {
  for (const char* shape : TypeParam::shapes) {
    SCOPED_TRACE(shape);
    TypeParam at(mesh_of(shape));
    at.certify();
    Random random(TypeParam::seed);
    int valid = 0, invalid = 0, partly = 0;
    for (int i = 0; i < at.motions(); ++i) {
      const Coordinates from = at.any_state(random), to = at.any_end(i, from, random);
      const State a(at.space, from), b(at.space, to), last(at.space, Coordinates(to.size(), 0.0));
      if (!at.space->isValid(a.get())) {
        EXPECT_FALSE(at.space->checkMotion(a.get(), b.get()));
        continue;
      }
      EXPECT_FALSE(at.comes_nearer(from, from));
      std::pair<base::State*, double> last_valid{last.get(), -1.0};
      if (at.space->checkMotion(a.get(), b.get(), last_valid)) {
        ++valid;
        EXPECT_FALSE(at.comes_nearer(from, to));
        EXPECT_EQ(last_valid.second, -1.0) << "must not change";
        continue;
      }
      ++invalid;
      const double share = last_valid.second;
      ASSERT_GE(share, 0.0);
      ASSERT_LT(share, 1.0);
      partly += share > 0.0 ? 1 : 0;
      const Coordinates end = last.values();
      for (std::size_t k = 0; k < to.size(); ++k) {
        EXPECT_NEAR(end[k], from[k] + share * (to[k] - from[k]), 1e-12);
      }
      EXPECT_FALSE(at.comes_nearer(from, end));
      EXPECT_TRUE(at.space->isValid(last.get()));
      EXPECT_TRUE(at.space->checkMotion(a.get(), last.get()));
      at.expect_a_reason(from, to, end);
    }
    EXPECT_GT(valid, at.least_of_each());
    EXPECT_GT(invalid, at.least_of_each());
    EXPECT_GT(partly, invalid / 4);
  }
}

TYPED_TEST(PlanningAt, AMotionThatLeavesTheBoundsEndsAtItsStart) {
  TypeParam at(mesh_of("cube"));
  at.certify();
  const State from(at.space, at.start), to(at.space, at.out_of_bounds),
      last(at.space, Coordinates(at.start.size(), 9.0)),
      nowhere(at.space, Coordinates(at.start.size(), test::nan));
  std::pair<base::State*, double> last_valid{last.get(), -1.0};
  EXPECT_FALSE(at.space->getMotionValidator()->checkMotion(from.get(), to.get(), last_valid));
  EXPECT_EQ(last_valid.second, 0.0);
  EXPECT_EQ(last.values(), at.start);
  EXPECT_FALSE(at.space->isValid(to.get()));
  EXPECT_FALSE(at.space->isValid(nowhere.get()));
}

TYPED_TEST(PlanningAt, AMotionOutOfAGuideIsInvalid) {
  const TypeParam at(mesh_of("cube"));
  const State from(at.space, at.start), within(at.space, at.beside), out(at.space, at.farther);
  EXPECT_TRUE(at.validator()->checkMotion(from.get(), out.get()));
  using Pool = typename decltype(at.guards)::element_type;
  const auto guided = std::make_shared<Pool>([&at] {
    auto guard = at.make();
    guard.set_guides({at.guide()});
    return guard;
  });
  const auto validator = make_motion_validator(at.space, guided);
  EXPECT_TRUE(validator->checkMotion(from.get(), within.get()));
  EXPECT_FALSE(validator->checkMotion(from.get(), out.get()));
  EXPECT_FALSE(make_state_validity_checker(at.space, guided)->isValid(out.get()));
}

TYPED_TEST(PlanningAt, NothingIsValidOnceTheMeshHasMoved) {
  const TypeParam at(mesh_of("cube"));
  const State from(at.space, at.start), to(at.space, at.farther);
  const auto validator = at.validator();
  const auto states = make_state_validity_checker(at.space, at.guards);
  EXPECT_TRUE(validator->checkMotion(from.get(), to.get()));
  EXPECT_TRUE(states->isValid(from.get()));
  at.index->refit(mesh_of("cube"));
  EXPECT_FALSE(validator->checkMotion(from.get(), to.get()));
  EXPECT_FALSE(states->isValid(from.get()));
}

TYPED_TEST(PlanningAt, ThreadsGetTheSameAnswersAndAreCounted) {
  const TypeParam at(mesh_of("gear"));
  const auto validator = at.validator();
  constexpr std::size_t count = 4, motions = 200;  // more threads than guards: some wait
  std::array<std::vector<bool>, count> results;
  std::vector<std::thread> threads;
  for (auto& result : results) {
    threads.emplace_back([&] {
      Random random(3);
      for (std::size_t i = 0; i < motions; ++i) {
        const State a(at.space, at.any_state(random)), b(at.space, at.any_state(random));
        result.push_back(validator->checkMotion(a.get(), b.get()));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, results.front());
  EXPECT_NE(std::ranges::count(results.front(), true), 0);
  EXPECT_EQ(validator->getCheckedMotionCount(), motions * count);
  EXPECT_LE(at.guards->made(), 2u);
}

/// Returns a plate without thickness at z = 0, 100 wide.
std::shared_ptr<const Mesh> sheet() { return mesh_of(make_flat_plate(10.0, 1)); }

TEST(Planning, SampledCheckingJumpsOverAPlateThatTheValidatorSees) {
  TipPlace at(sheet());
  at.certify();
  const base::DiscreteMotionValidator sampled(at.space);
  const State above(at.space, {1, 2, 0.6}), below(at.space, {1, 2, -0.6});
  EXPECT_TRUE(sampled.checkMotion(above.get(), below.get()));
  EXPECT_FALSE(at.space->checkMotion(above.get(), below.get()));
}

TEST(Planning, AStateNearerThanTheMarginIsInvalid) {
  const TipPlace at(sheet());
  constexpr double margin = TipPlace::kept;
  EXPECT_TRUE(at.is_valid({3, 4, margin}));
  EXPECT_TRUE(at.is_valid({3, 4, -margin})) << "an open mesh has no sides";
  EXPECT_FALSE(at.is_valid({3, 4, margin - 1e-6}));
  EXPECT_FALSE(at.is_valid({3, 4, 0.0}));
  EXPECT_TRUE(at.is_valid({3, 4, 9.9}));
  EXPECT_FALSE(at.is_valid({3, 4, 10.1})) << "out of bounds";
}

TEST(Planning, WithSidesTheInsideIsInvalidAndWithoutItIsAnotherRoom) {
  const Coordinates centre{0, 0, 0};
  EXPECT_FALSE(TipPlace(mesh_of("sphere")).is_valid(centre));
  const TipPlace no_sides(mesh_of("sphere"), Inside::taken_as_is);
  EXPECT_TRUE(no_sides.is_valid(centre));
  const State from(no_sides.space, centre), outside(no_sides.space, {0, 0, 55});
  EXPECT_FALSE(no_sides.validator()->checkMotion(from.get(), outside.get()));
}

TEST(Planning, AWrongSpaceIsRefusedWithAWordOnWhatToDo) {
  const TipPlace at(mesh_of("cube"));
  const auto plane = std::make_shared<base::RealVectorStateSpace>(2);
  plane->setBounds(-1, 1);
  EXPECT_CONTAINS(at.refusal(plane), "RealVectorStateSpace>(3)");
  EXPECT_CONTAINS(at.refusal(std::make_shared<base::SE3StateSpace>()), "6 dimensions");
  EXPECT_CONTAINS(at.refusal(std::make_shared<base::RealVectorStateSpace>(3)), "setBounds");
  EXPECT_CONTAINS(error_of([&] { make_motion_validator(at.space, std::shared_ptr<GuardPool>()); }),
                  "GuardPool");
  EXPECT_THROW(set_certified_checkers(nullptr, at.guards), Error);
  EXPECT_THROW(make_sliding_connect(at.space, at.guards, {.sliding_step = 6.0}), Error);
}

/// Returns a path from one side of the cortex to the other; empty if the planner fails.
std::vector<Coordinates> planned(std::uint64_t seed, bool slides, double range = 0.0) {
  TipPlace at(mesh_of("cortex"));
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  at.certify();
  base::PlannerPtr planner = make_sliding_connect(at.space, at.guards);
  if (!slides) planner = std::make_shared<ompl::geometric::RRTConnect>(at.space);
  if (range > 0.0) planner->params().setParam("range", std::to_string(range));
  const State start(at.space, {-56, 0, 0}), goal(at.space, {56, 0, 0});
  const std::vector<Coordinates> path = solved(*planner, start, goal, 10.0);
  if (path.empty()) return path;
  base::PlannerData data(at.space);
  planner->getPlannerData(data);
  EXPECT_GE(data.numVertices(), 2u);
  EXPECT_EQ(data.numStartVertices(), 1u);
  return path;
}

TEST(Planning, BothPlannersFindPathsThatTheOraclePasses) {
  TipPlace at(mesh_of("cortex"));
  for (const bool slides : {false, true}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const std::vector<Coordinates> tips = planned(seed, slides);
      ASSERT_GE(tips.size(), 2u) << "not solved";
      EXPECT_EQ(tips.front(), (Coordinates{-56, 0, 0}));
      EXPECT_EQ(tips.back(), (Coordinates{56, 0, 0}));
      for (std::size_t i = 1; i < tips.size(); ++i) {
        EXPECT_FALSE(at.comes_nearer(tips[i - 1], tips[i]));
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
  const TipPlace at(mesh_of("sphere"));
  const base::SpaceInformationPtr& space = at.space;
  // The planner checks the states itself, even if the checker of the space accepts everything.
  space->setStateValidityChecker([](const base::State*) { return true; });
  space->setup();
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  base::ScopedState<base::RealVectorStateSpace> inside(space), outside(space);
  for (unsigned int i = 0; i < 3; ++i) inside[i] = 0.0, outside[i] = 45.0;
  const auto status = [&](const auto& start, const auto& goal) {
    definition->clearSolutionPaths();
    definition->setStartAndGoalStates(start, goal);
    const auto planner = make_sliding_connect(space, at.guards);
    planner->setProblemDefinition(definition);
    planner->setup();
    return static_cast<base::PlannerStatus::StatusType>(planner->solve(1.0));
  };
  EXPECT_EQ(status(inside, outside), base::PlannerStatus::INVALID_START);
  EXPECT_EQ(status(outside, inside), base::PlannerStatus::INVALID_GOAL);
}

// Tests of instruments only.

TEST(JointPlanning, ATipThatDipsBetweenTwoSamplesIsSeen) {
  // The shaft swings about the port, over a plate without thickness. Its tip is lowest halfway, by
  // some micrometers.
  InstrumentPlace at(mesh_of(make_flat_plate(10.0, 1)));
  at.certify();
  const base::DiscreteMotionValidator sampled(at.space);
  const auto verdicts = [&](double above) {
    const double insertion = 60.0 + 15.6 - 9.1 - 10.2 - 1.0 - above;
    const Coordinates from{-0.018, 0, insertion, 0, 0, 0}, to{0.018, 0, insertion, 0, 0, 0};
    EXPECT_NEAR(at.least(from, to, 100), above, 1e-9);
    const State a(at.space, from), b(at.space, to);
    return std::pair{sampled.checkMotion(a.get(), b.get()),
                     at.space->checkMotion(a.get(), b.get())};
  };
  EXPECT_EQ(verdicts(InstrumentPlace::kept + 0.001), std::pair(true, true));
  EXPECT_EQ(verdicts(InstrumentPlace::kept - 0.001), std::pair(true, false));
  EXPECT_EQ(verdicts(InstrumentPlace::kept - 0.020), std::pair(false, false));
}

TEST(JointPlanning, TheLastValidStateMayBeTheMotionsOwn) {
  const InstrumentPlace at(mesh_of("cube"));
  const auto validator = at.validator();
  const State from(at.space, {0, 0, 20, 0, 0, 0}), to(at.space, {0, 0, 130, 0, 0, 0});
  std::pair<base::State*, double> last_valid{to.get(), -1.0};
  EXPECT_FALSE(validator->checkMotion(from.get(), to.get(), last_valid));
  EXPECT_GT(last_valid.second, 0.0);
  EXPECT_EQ(to.values()[2], 20.0 + last_valid.second * 110.0);
}

TEST(JointPlanning, TheSpaceMeasuresHowFarAJointMovesTheInstrument) {
  const InstrumentPlace at(mesh_of("cube"));
  EXPECT_EQ(at.guards->options().margin, 0.2);
  const auto& space = at.space->getStateSpace();
  const auto apart = [&](int joint, double by) {
    Coordinates q{0, 0, 120, 0, 0, 0};
    const State a(at.space, q);
    q[static_cast<std::size_t>(joint)] += by;
    const State b(at.space, q);
    return space->distance(a.get(), b.get());
  };
  EXPECT_DOUBLE_EQ(apart(2, 7.0), 7.0);
  // At full insertion, the tip is 240 - 15.6 + 9.1 + 10.2 from the port. The bent wrist has a lever
  // of 19.3.
  EXPECT_NEAR(apart(0, 0.1), 24.37, 1e-9);
  EXPECT_GT(apart(3, 0.1), 1.5);
  EXPECT_LT(apart(3, 0.1), 1.93);
  EXPECT_NEAR(apart(5, 0.1), 1.02, 1e-9);
  // The extent is the distance from all lower limits to all upper limits.
  EXPECT_GT(space->getMaximumExtent(), 2.0 * 1.588 * 243.7);
}

TEST(JointPlanning, AWrongSpaceIsRefusedWithAWordOnWhatToDo) {
  const InstrumentPlace at(mesh_of("cube"));
  EXPECT_CONTAINS(at.refusal(std::make_shared<base::RealVectorStateSpace>(3)), "make_joint_space");
  EXPECT_CONTAINS(at.refusal(std::make_shared<base::SE3StateSpace>()), "6 dimensions");
  const auto wide = std::make_shared<base::RealVectorStateSpace>(6);
  EXPECT_CONTAINS(at.refusal(wide), "setBounds");
  wide->setBounds(-2.0, 2.0);
  EXPECT_CONTAINS(at.refusal(wide), "joint 'yaw'");
  wide->setBounds(0.0, 0.5);
  EXPECT_EQ(at.refusal(wide), "no error") << "any space within the limits will do";
  EXPECT_CONTAINS(
      error_of([&] { make_motion_validator(at.space, std::shared_ptr<InstrumentPool>()); }),
      "InstrumentPool");
  EXPECT_CONTAINS(error_of([&] { make_state_validity_checker(nullptr, at.guards); }),
                  "SpaceInformation");
  const Instrument free(Chain({{.name = "hinge"}}), {{"ball", {{1, Vec3::Zero()}}, 1.0}});
  EXPECT_CONTAINS(error_of([&] { make_joint_space(free); }), "joint 'hinge' has no limits");
}

TEST(JointPlanning, APlannerFindsAPathThatTheJudgePasses) {
  InstrumentPlace at(mesh_of("cube"));
  ompl::RNG::setSeed(2);
  at.certify();
  // The path goes from one side of the cube to the other. On a straight path, the shaft would pass
  // through the cube.
  const double depth = (60.0 + 15.6 + 20.0) / std::cos(0.95);
  const State start(at.space, {-0.95, 0, depth, 0, 0, 0}),
      goal(at.space, {0.95, 0, depth, 0, 0, 0});
  ASSERT_TRUE(at.space->isValid(start.get()));
  ASSERT_TRUE(at.space->isValid(goal.get()));
  ASSERT_FALSE(at.space->checkMotion(start.get(), goal.get()));
  ompl::geometric::RRTConnect planner(at.space);
  const std::vector<Coordinates> path = solved(planner, start, goal, 30.0);
  ASSERT_GE(path.size(), 3u);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_GE(at.least(path[i - 1], path[i], 500), at.kept - at.tolerance);
  }
}

}  // namespace
}  // namespace keepout::test::planning
