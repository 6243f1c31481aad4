// SPDX-License-Identifier: BSD-3-Clause
// keepout verify --scenario: what is promised in each scenario holds, and a step that is broken in
// a way of its own is found out.

#include <memory>
#include <span>
#include <utility>

#include "apps/command_process.h"
#include "small_campaign.h"
#include "trials.h"
#include "verify/robot/campaign.h"

namespace keepout::app {
namespace {

using Make = std::function<std::unique_ptr<RobotSubject>(const RobotSetup&)>;

/// A short campaign of one scenario on one kind of mesh.
RobotTally run(const std::string& scenario, const std::string& mesh, std::uint64_t cycles,
               const Make& make = &make_subject) {
  std::vector<Arena> arenas = hostile_arenas("wide_bvh");
  std::erase_if(arenas, [&](const Arena& arena) { return arena.mesh != mesh; });
  const RobotCampaign campaign{.scenarios = {scenario},
                               .cycles = test::trials(cycles),
                               .speeds = {1.0},
                               .make_subject = make};
  return run_campaign(campaign, arenas, go_on).at(0);
}

class EveryScenario : public testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(
    Verify, EveryScenario,
    testing::Values(std::pair{"approach", "cone"}, std::pair{"approach", "sheets"},
                    std::pair{"guides", "soup"}, std::pair{"blade", "saddle"},
                    std::pair{"moving", "bowl"}, std::pair{"meshes", "fan"},
                    std::pair{"stuck", "saddle"}, std::pair{"unlimited", "saddle"},
                    std::pair{"tip_guides", "soup"}, std::pair{"convex_tool", "cone"}),
    [](const auto& row) { return std::string(row.param.first) + "_" + row.param.second; });

TEST_P(EveryScenario, KeepsWhatIsPromised) {
  const RobotTally row = run(GetParam().first, GetParam().second, 2000);
  EXPECT_EQ(row.below, 0u) << row.least_in_tau;
  EXPECT_EQ(row.guides_left, 0u) << row.least_guide_in_tau;
  EXPECT_EQ(row.limits_broken, 0u);
  EXPECT_EQ(row.cycles, test::trials(std::uint64_t{2000}));
  EXPECT_GT(row.blocked, test::trials(20u)) << "and it was pressed on something";
}

void widen_guides(RobotSetup& setup) {
  for (oracle::JudgedGuide& guide : setup.guides) {
    guide.radius += 3.0 * guide.band;
    if (guide.region == oracle::JudgedGuide::Region::half_space) {
      guide.radius = 0.0;
      guide.origin -= 3.0 * guide.band * guide.direction;
    }
  }
}

/// Removes the first of three points or more of the last body.
void cut_off_a_corner(RobotSetup& setup) {
  const auto cut = [](auto& points) { points.erase(points.begin()); };
  setup.robot.make = [make = setup.robot.make, cut](const Pose& base) {
    const Instrument whole = make(base);
    std::vector<Body> bodies(whole.bodies().begin(), whole.bodies().end());
    cut(bodies.back().points);
    return Instrument(whole.chain(), std::move(bodies));
  };
  setup.robot.judged = [judged = setup.robot.judged(), cut] {
    oracle::JudgedRobot robot = judged;
    cut(robot.bodies.back().points);
    return robot;
  };
}

/// Stands still where it should give way.
void freeze(InstrumentStep& step, std::vector<double>&) {
  if (step.status != Status::free) step = {.status = Status::unsolved, .level = 0.0};
}

/// Makes twice the motion that is free.
void overshoot(InstrumentStep& step, std::vector<double>& longer) {
  if (step.status != Status::free) return;
  longer.assign(step.increment.begin(), step.increment.end());
  for (double& x : longer) x *= 2.2;
  step.increment = longer;
}

/// A subject that is broken in a single respect. The judge goes on with the setup that was drawn.
struct Defect {
  void (*of_setup)(RobotSetup&) = [](RobotSetup&) {};
  void (*of_step)(InstrumentStep&, std::vector<double>&) = [](auto&, auto&) {};
  double margin_less = 0.0;  // [tolerances]
  bool knows_velocities = true;
};

class Broken final : public RobotSubject {
 public:
  Broken(RobotSetup setup, const Defect& defect) : defect_(defect) {
    defect.of_setup(setup);
    meshes_ = setup.meshes.size();
    subject_ = make_subject(setup);
  }
  void set_options(const InstrumentOptions& options) override {
    InstrumentOptions less = options;
    less.margin -= defect_.margin_less * tolerance();
    subject_->set_options(less);
  }
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity) override {
    if (mesh < meshes_) subject_->place(mesh, pose, defect_.knows_velocities ? velocity : Twist{});
  }
  InstrumentStep step(std::span<const double> q, const Twist& desired) override {
    InstrumentStep step = subject_->step(q, desired);
    defect_.of_step(step, increment_);
    return step;
  }
  double tolerance() const override { return subject_->tolerance(); }

 private:
  Defect defect_;
  std::size_t meshes_;
  std::unique_ptr<RobotSubject> subject_;
  std::vector<double> increment_;
};

RobotTally run_broken(const std::string& scenario, const std::string& mesh, std::uint64_t cycles,
                      const Defect& defect) {
  return run(scenario, mesh, cycles,
             [&](const RobotSetup& setup) { return std::make_unique<Broken>(setup, defect); });
}

struct SabotagedRow {
  const char* name;
  const char* scenario;
  const char* mesh;
  Defect defect;
  std::uint64_t RobotTally::*count = &RobotTally::below;
};
class SabotagedScenario : public testing::TestWithParam<SabotagedRow> {};
INSTANTIATE_TEST_SUITE_P(
    Verify, SabotagedScenario,
    testing::Values(
        SabotagedRow{"GuidesThatAreTooWide",
                     "guides",
                     "saddle",
                     {.of_setup = widen_guides},
                     &RobotTally::guides_left},
        SabotagedRow{"GuidesOfATipThatAreTooWide",
                     "tip_guides",
                     "saddle",
                     {.of_setup = widen_guides},
                     &RobotTally::guides_left},
        SabotagedRow{"AMeshWhoseVelocityIsNotKnown", "moving", "bowl", {.knows_velocities = false}},
        SabotagedRow{"AMeshThatIsForgotten",
                     "meshes",
                     "bowl",
                     {.of_setup = [](RobotSetup& setup) { setup.meshes.pop_back(); }}},
        SabotagedRow{
            "ACornerOfABladeThatIsForgotten", "blade", "saddle", {.of_setup = cut_off_a_corner}},
        SabotagedRow{"ACornerOfAConvexToolThatIsForgotten",
                     "convex_tool",
                     "saddle",
                     {.of_setup = cut_off_a_corner}},
        SabotagedRow{"AToolThatDoesNotGiveWay", "stuck", "saddle", {.of_step = freeze}},
        SabotagedRow{
            "AMarginThatIsTenTolerancesTooSmall", "convex_tool", "saddle", {.margin_less = 10.0}}),
    by_name);

TEST_P(SabotagedScenario, IsCaught) {
  const SabotagedRow& row = GetParam();
  const RobotTally tally = run_broken(row.scenario, row.mesh, 10'000, row.defect);
  EXPECT_GT(tally.*row.count, 0u);
  EXPECT_GT(tally.first_breach, 0u);
  RecordProperty("first_breach", std::to_string(tally.first_breach));
}

TEST(BrokenStep, MotionsThatOvershootAreCounted) {
  const RobotTally row = run_broken("unlimited", "saddle", 2000, {.of_step = overshoot});
  EXPECT_GT(row.strayed, test::trials(100u));
  EXPECT_GE(breaches(row), row.strayed);
}

TEST(BrokenStep, StandingStillForNothingIsCounted) {
  const RobotTally lazy = run_broken("approach", "saddle", 2000, {.of_step = freeze});
  EXPECT_GT(lazy.movable, lazy.samples / 4);
}

TEST(VerifyScenario, IsChosenByNameAndUnknownNamesSuggest) {
  const test::CommandFolder folder;
  const test::ProcessOutcome outcome = succeeded(
      folder.run("verify cortex --scenario tip_guides,convex_tool --cycles 200 --speed 1"));
  EXPECT_CONTAINS(outcome.output, "No breach in 400 cycles.");
  folder.expect_refused("verify --scenario guide", "did you mean 'guides'");
}

}  // namespace
}  // namespace keepout::app
