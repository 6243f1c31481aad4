// SPDX-License-Identifier: BSD-3-Clause
// Planning for whole instruments with OMPL, held to the judge that shares nothing with the library.
#include "keepout/ompl/joint_planning.h"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/oracle/instrument_oracle.h"
#include "meshes.h"
#include "messages.h"
#include "states.h"
#include "trials.h"

namespace keepout::test::joint_planning {
namespace {

constexpr double kept = 0.198;     // margin less band
constexpr double rounding = 1e-8;  // far above 3 tau of an instrument of this size
using Joints = Coordinates;

/// A manipulator over a shape, that hangs down from a port above it.
struct Workplace {
  std::shared_ptr<const Mesh> mesh;
  Instrument instrument;
  std::shared_ptr<InstrumentPool> guards;
  base::SpaceInformationPtr space;
};

Workplace workplace(const std::shared_ptr<const Mesh>& mesh) {
  ompl::msg::noOutputHandler();
  const Vec3 port(0.0, 0.0, mesh->bounds().high.z() + 60.0);
  const Instrument instrument = psm({port, Mat3::Identity()});
  const auto guards = std::make_shared<InstrumentPool>(
      [mesh, instrument] { return make_instrument_constraint(mesh, instrument, {}); }, 2);
  return {mesh, instrument, guards,
          std::make_shared<base::SpaceInformation>(make_joint_space(instrument))};
}

Workplace workplace(std::string_view shape) { return workplace(mesh_of(shape)); }

class Judge {
 public:
  explicit Judge(const Workplace& at)
      : oracle_(std::make_shared<const oracle::TriangleTree>(at.mesh), oracle::judged_psm(),
                at.instrument.chain().base()) {}

  /// The least clearance of all bodies on the motion, at so many places; infinite above 1. [mm]
  double least(const Joints& from, const Joints& to, int places) {
    double clearance = test::infinity;
    for (int i = 0; i <= places; ++i) {
      Joints q = from;
      for (std::size_t k = 0; k < q.size(); ++k) q[k] += i * (to[k] - from[k]) / places;
      oracle_.move_to(q);
      clearance = std::min(clearance, oracle_.clearance(1.0));
    }
    return clearance;
  }

 private:
  oracle::InstrumentOracle oracle_;
};

/// Above the shape or within it; the wrist is bent any way.
Joints any_configuration(Random& random) {
  return {random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), random.uniform(20.0, 130.0),
          random.uniform(-3.0, 3.0), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)};
}

class JointPlanningOn : public testing::TestWithParam<const char*> {};

TEST_P(JointPlanningOn, NothingIsCalledValidThatTheJudgeFindsTooClose) {
  const Workplace at = workplace(GetParam());
  set_certified_checkers(at.space, at.guards);
  at.space->setup();
  Judge judge(at);
  Random random(11);
  int valid = 0, invalid = 0, partly = 0;
  for (int i = 0; i < test::trials(2000); ++i) {
    const Joints from = any_configuration(random);
    Joints to = any_configuration(random);
    // Long ones, and short ones that end near where they begin.
    const double share = i % 2 == 0 ? 1.0 : random.uniform(0.0, 0.2);
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[k] + share * (to[k] - from[k]);
    const State a(at.space, from), b(at.space, to), last(at.space, Joints(6, 0.0));
    if (!at.space->isValid(a.get())) {
      EXPECT_FALSE(at.space->checkMotion(a.get(), b.get()));
      continue;
    }
    EXPECT_GE(judge.least(from, from, 1), kept - rounding);
    std::pair<base::State*, double> last_valid{last.get(), -1.0};
    if (at.space->checkMotion(a.get(), b.get(), last_valid)) {
      ++valid;
      EXPECT_GE(judge.least(from, to, 60), kept - rounding);
      EXPECT_EQ(last_valid.second, -1.0) << "is not to be touched";
      continue;
    }
    ++invalid;
    ASSERT_GE(last_valid.second, 0.0);
    ASSERT_LT(last_valid.second, 1.0);
    partly += last_valid.second > 0.0 ? 1 : 0;
    for (std::size_t k = 0; k < to.size(); ++k) {
      EXPECT_NEAR(last.values()[k], from[k] + last_valid.second * (to[k] - from[k]), 1e-12);
    }
    EXPECT_GE(judge.least(from, last.values(), 60), kept - rounding);
    EXPECT_TRUE(at.space->isValid(last.get()));
    EXPECT_TRUE(at.space->checkMotion(a.get(), last.get()));
  }
  EXPECT_GT(valid, test::trials(2000) / 40);
  EXPECT_GT(invalid, test::trials(2000) / 40);
  EXPECT_GT(partly, invalid / 4);
}

INSTANTIATE_TEST_SUITE_P(Shapes, JointPlanningOn,
                         testing::Values("cube", "gear", "thin_plates", "cortex", "triangle_soup"),
                         by_name);

TEST(JointPlanning, ATipThatDipsBetweenTwoSamplesIsSeen) {
  // It swings about the port, over a plate of no thickness: lowest halfway, by some micrometres.
  const Workplace at = workplace(mesh_of(make_flat_plate(10.0, 1)));
  set_certified_checkers(at.space, at.guards);
  at.space->setup();
  const base::DiscreteMotionValidator sampled(at.space);
  const auto verdicts = [&](double above) {
    const double insertion = 60.0 + 15.6 - 9.1 - 10.2 - 1.0 - above;
    const Joints from{-0.018, 0, insertion, 0, 0, 0}, to{0.018, 0, insertion, 0, 0, 0};
    EXPECT_NEAR(Judge(at).least(from, to, 100), above, 1e-9);
    const State a(at.space, from), b(at.space, to);
    return std::pair{sampled.checkMotion(a.get(), b.get()),
                     at.space->checkMotion(a.get(), b.get())};
  };
  EXPECT_EQ(verdicts(kept + 0.001), std::pair(true, true));
  EXPECT_EQ(verdicts(kept - 0.001), std::pair(true, false));
  EXPECT_EQ(verdicts(kept - 0.020), std::pair(false, false));
}

TEST(JointPlanning, AMotionThatLeavesTheBoundsEndsAtItsStart) {
  const Workplace at = workplace("cube");
  set_certified_checkers(at.space, at.guards);
  at.space->setup();
  const State a(at.space, {0, 0, 20, 0, 0, 0}), b(at.space, {0, 0, -1, 0, 0, 0});
  expect_invalid_from_the_start(*at.space->getMotionValidator(), at.space, a, b);
  EXPECT_FALSE(at.space->isValid(b.get()));
  const State nowhere(at.space, Joints(6, test::nan));
  EXPECT_FALSE(at.space->isValid(nowhere.get()));
}

TEST(JointPlanning, AMotionOutOfAGuideIsInvalid) {
  const Workplace at = workplace("cube");
  const State from(at.space, {0, 0, 20, 0, 0, 0}), to(at.space, {0, 0, 24, 0, 0, 0});
  EXPECT_TRUE(make_motion_validator(at.space, at.guards)->checkMotion(from.get(), to.get()));
  ChainState chain;
  at.instrument.chain().forward_kinematics(from.values(), chain);
  const Guide near =
      Guide::point("near", {6, Vec3::Zero()}, Region::ball(chain.link(6).position, 1.0));
  const auto guided = std::make_shared<InstrumentPool>([&at, &near] {
    InstrumentConstraint guard = make_instrument_constraint(at.mesh, at.instrument, {});
    guard.set_guides({near});
    return guard;
  });
  EXPECT_FALSE(make_motion_validator(at.space, guided)->checkMotion(from.get(), to.get()));
}

TEST(JointPlanning, NothingIsValidOnceTheMeshHasMoved) {
  const Workplace at = workplace("cube");
  const auto tree = std::make_shared<WideBvh>(at.mesh);
  const auto guards = std::make_shared<InstrumentPool>(
      [&] { return make_instrument_constraint(at.mesh, tree, at.instrument, {}); }, 1);
  const State from(at.space, {0, 0, 20, 0, 0, 0}), to(at.space, {0, 0, 24, 0, 0, 0});
  const auto validator = make_motion_validator(at.space, guards);
  EXPECT_TRUE(validator->checkMotion(from.get(), to.get()));
  tree->refit(mesh_of("cube"));
  EXPECT_FALSE(validator->checkMotion(from.get(), to.get()));
}

TEST(JointPlanning, TheLastValidStateMayBeTheMotionsOwn) {
  const Workplace at = workplace("cube");
  const auto validator = make_motion_validator(at.space, at.guards);
  const State from(at.space, {0, 0, 20, 0, 0, 0}), to(at.space, {0, 0, 130, 0, 0, 0});
  std::pair<base::State*, double> last_valid{to.get(), -1.0};
  EXPECT_FALSE(validator->checkMotion(from.get(), to.get(), last_valid));
  EXPECT_GT(last_valid.second, 0.0);
  EXPECT_EQ(to.values()[2], 20.0 + last_valid.second * 110.0);
}

TEST(JointPlanning, ThreadsGetTheSameAnswers) {
  const Workplace at = workplace("gear");
  const auto validator = make_motion_validator(at.space, at.guards);
  // One thread more than guards: it waits.
  const auto answers = answers_of_threads(*validator, at.space, 3, any_configuration);
  EXPECT_NE(std::ranges::count(answers, true), 0);
  EXPECT_LE(at.guards->made(), 2u);
  EXPECT_EQ(at.guards->options().margin, 0.2);
}

TEST(JointPlanning, TheSpaceMeasuresHowFarAJointMovesTheInstrument) {
  const Workplace at = workplace("cube");
  const auto& space = at.space->getStateSpace();
  const auto apart = [&](int joint, double by) {
    Joints q{0, 0, 120, 0, 0, 0};
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
  const Workplace at = workplace("cube");
  const auto told = [&](const base::StateSpacePtr& space) {
    return error_of(
        [&] { make_motion_validator(std::make_shared<base::SpaceInformation>(space), at.guards); });
  };
  EXPECT_CONTAINS(told(std::make_shared<base::RealVectorStateSpace>(3)), "make_joint_space");
  EXPECT_CONTAINS(told(std::make_shared<base::SE3StateSpace>()), "6 dimensions");
  const auto wide = std::make_shared<base::RealVectorStateSpace>(6);
  EXPECT_CONTAINS(told(wide), "setBounds");
  wide->setBounds(-2.0, 2.0);
  EXPECT_CONTAINS(told(wide), "joint 'yaw'");
  wide->setBounds(0.0, 0.5);
  EXPECT_EQ(told(wide), "no error") << "any space within the limits will do";
  EXPECT_CONTAINS(
      error_of([&] { make_motion_validator(at.space, std::shared_ptr<InstrumentPool>()); }),
      "InstrumentPool");
  EXPECT_CONTAINS(error_of([&] { make_state_validity_checker(nullptr, at.guards); }),
                  "SpaceInformation");
  const Instrument free(Chain({{.name = "hinge"}}), {{"ball", {{1, Vec3::Zero()}}, 1.0}});
  EXPECT_CONTAINS(error_of([&] { make_joint_space(free); }), "joint 'hinge' has no limits");
}

TEST(JointPlanning, APlannerFindsAPathThatTheJudgePasses) {
  const Workplace at = workplace("cube");
  ompl::RNG::setSeed(2);
  set_certified_checkers(at.space, at.guards);
  at.space->setup();
  // From one side of the cube to the other; straight on the shaft would go through it.
  const double depth = (60.0 + 15.6 + 20.0) / std::cos(0.95);
  const State start(at.space, {-0.95, 0, depth, 0, 0, 0}),
      goal(at.space, {0.95, 0, depth, 0, 0, 0});
  ASSERT_TRUE(at.space->isValid(start.get()));
  ASSERT_TRUE(at.space->isValid(goal.get()));
  ASSERT_FALSE(at.space->checkMotion(start.get(), goal.get()));
  ompl::geometric::RRTConnect planner(at.space);
  const std::vector<Joints> path = solved(planner, start, goal, 30.0);
  ASSERT_GE(path.size(), 3u);
  Judge judge(at);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_GE(judge.least(path[i - 1], path[i], 500), kept - rounding);
  }
}

}  // namespace
}  // namespace keepout::test::joint_planning
