// SPDX-License-Identifier: BSD-3-Clause
// Planning for whole instruments with OMPL: what tips have not.
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>

#include "workplaces.h"

namespace keepout::test::joint_planning {
namespace {

constexpr double kept = InstrumentPlace::kept;

TEST(JointPlanning, ATipThatDipsBetweenTwoSamplesIsSeen) {
  // It swings about the port, over a plate of no thickness: lowest halfway, by some micrometres.
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
  EXPECT_EQ(verdicts(kept + 0.001), std::pair(true, true));
  EXPECT_EQ(verdicts(kept - 0.001), std::pair(true, false));
  EXPECT_EQ(verdicts(kept - 0.020), std::pair(false, false));
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
  // At full insertion the tip is 240 - 15.6 + 9.1 + 10.2 from the port; bent, the wrist has 19.3.
  EXPECT_NEAR(apart(0, 0.1), 24.37, 1e-9);
  EXPECT_GT(apart(3, 0.1), 1.5);
  EXPECT_LT(apart(3, 0.1), 1.93);
  EXPECT_NEAR(apart(5, 0.1), 1.02, 1e-9);
  // From all lower limits to all upper ones.
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
  // From one side of the cube to the other; straight on the shaft would go through it.
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
    EXPECT_GE(at.least(path[i - 1], path[i], 500), kept - InstrumentPlace::tolerance);
  }
}

}  // namespace
}  // namespace keepout::test::joint_planning
