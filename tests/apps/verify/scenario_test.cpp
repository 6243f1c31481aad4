// SPDX-License-Identifier: BSD-3-Clause
// keepout verify --scenario: what is promised in each scenario holds, and a step that is broken in
// a way of its own is found out.
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <utility>

#include "apps/command_process.h"
#include "trials.h"
#include "verify/robot/campaign.h"
#include "verify/robot/hostile_mesh.h"

namespace keepout::app {
namespace {

using Make = std::unique_ptr<RobotSubject> (*)(const RobotSetup&);

/// A short campaign of one scenario on one kind of mesh.
RobotTally run(const std::string& scenario, const std::string& mesh, std::uint64_t cycles,
               Make make = &make_subject) {
  std::vector<Arena> arenas = hostile_arenas("wide_bvh");
  std::erase_if(arenas, [&](const Arena& arena) { return arena.mesh != mesh; });
  const RobotCampaign campaign{.scenarios = {scenario},
                               .cycles = test::trials(cycles),
                               .speeds = {1.0},
                               .make_subject = make};
  return run_robot_campaign(campaign, arenas,
                            [](const RobotTally&, std::uint64_t) { return Next::go_on; })
      .at(0);
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

/// Changes the setup before the step is made of it: the judge goes on with what was drawn.
template <class Change>
std::unique_ptr<RobotSubject> changed(const RobotSetup& setup, const Change& change) {
  RobotSetup other = setup;
  change(other);
  return make_subject(other);
}

std::unique_ptr<RobotSubject> with_wide_guides(const RobotSetup& setup) {
  return changed(setup, [](RobotSetup& other) {
    for (oracle::JudgedGuide& guide : other.guides) {
      guide.radius += 3.0 * guide.band;
      if (guide.region == oracle::JudgedGuide::Region::half_space) {
        guide.radius = 0.0;
        guide.origin -= 3.0 * guide.band * guide.direction;
      }
    }
  });
}

/// Without the first of three points or more of the last body.
std::unique_ptr<RobotSubject> with_a_corner_cut_off(const RobotSetup& setup) {
  return changed(setup, [](RobotSetup& other) {
    const auto cut = [](auto& points) { points.erase(points.begin()); };
    other.robot.make = [make = other.robot.make, cut](const Pose& base) {
      const Instrument whole = make(base);
      std::vector<Body> bodies(whole.bodies().begin(), whole.bodies().end());
      cut(bodies.back().points);
      return Instrument(whole.chain(), std::move(bodies));
    };
    other.robot.judged = [judged = other.robot.judged(), cut] {
      oracle::JudgedRobot robot = judged;
      cut(robot.bodies.back().points);
      return robot;
    };
  });
}

/// Passes everything on; the base of subjects that are broken in a single respect.
class Broken : public RobotSubject {
 public:
  explicit Broken(const RobotSetup& setup) : subject_(make_subject(setup)) {}
  void set_options(const InstrumentOptions& o) override { subject_->set_options(o); }
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity) override {
    subject_->place(mesh, pose, velocity);
  }
  InstrumentStep step(std::span<const double> q, const Twist& desired) override {
    return subject_->step(q, desired);
  }
  double tolerance() const override { return subject_->tolerance(); }

 private:
  std::unique_ptr<RobotSubject> subject_;
};

/// Does not know of the last mesh.
class Forgetful final : public Broken {
 public:
  explicit Forgetful(const RobotSetup& setup)
      : Broken(without_the_last_mesh(setup)), meshes_(setup.meshes.size() - 1) {}
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity) override {
    if (mesh < meshes_) Broken::place(mesh, pose, velocity);
  }

 private:
  static RobotSetup without_the_last_mesh(RobotSetup setup) {
    setup.meshes.pop_back();
    return setup;
  }

  std::size_t meshes_;
};

/// Knows where meshes are, and not how they move.
class Velocityless final : public Broken {
 public:
  using Broken::Broken;
  void place(std::size_t mesh, const Pose& pose, const Twist&) override {
    Broken::place(mesh, pose, {});
  }
};

/// Keeps a margin that is ten tolerances too small.
class Careless final : public Broken {
 public:
  using Broken::Broken;
  void set_options(const InstrumentOptions& options) override {
    InstrumentOptions less = options;
    less.margin -= 10.0 * tolerance();
    Broken::set_options(less);
  }
};

/// Stands still where it should give way.
class Frozen final : public Broken {
 public:
  using Broken::Broken;
  InstrumentStep step(std::span<const double> q, const Twist& desired) override {
    InstrumentStep step = Broken::step(q, desired);
    if (step.status != Status::free) return {.status = Status::unsolved, .level = 0.0};
    return step;
  }
};

/// Makes twice the motion that is free.
class Overshooting final : public Broken {
 public:
  using Broken::Broken;
  InstrumentStep step(std::span<const double> q, const Twist& desired) override {
    InstrumentStep step = Broken::step(q, desired);
    if (step.status != Status::free) return step;
    longer_.assign(step.increment.begin(), step.increment.end());
    for (double& x : longer_) x *= 2.2;
    step.increment = longer_;
    return step;
  }

 private:
  std::vector<double> longer_;
};

template <class Kind>
std::unique_ptr<RobotSubject> make(const RobotSetup& setup) {
  return std::make_unique<Kind>(setup);
}

constexpr std::uint64_t enough = 10'000;  // cycles

void expect_caught(const std::string& scenario, const std::string& mesh, Make make,
                   auto RobotTally::*count) {
  const RobotTally row = run(scenario, mesh, enough, make);
  EXPECT_GT(row.*count, 0u);
  EXPECT_GT(row.first_breach, 0u);
  std::printf("%s: first breach in cycle %llu\n", row.scenario.c_str(),
              static_cast<unsigned long long>(row.first_breach));
}

TEST(SabotagedScenario, GuidesThatAreTooWideAreCaught) {
  expect_caught("guides", "saddle", with_wide_guides, &RobotTally::guides_left);
}

TEST(SabotagedScenario, GuidesOfATipThatAreTooWideAreCaught) {
  expect_caught("tip_guides", "saddle", with_wide_guides, &RobotTally::guides_left);
}

TEST(SabotagedScenario, AMeshWhoseVelocityIsNotKnownIsCaught) {
  expect_caught("moving", "bowl", make<Velocityless>, &RobotTally::below);
}

TEST(SabotagedScenario, AMeshThatIsForgottenIsCaught) {
  expect_caught("meshes", "bowl", make<Forgetful>, &RobotTally::below);
}

TEST(SabotagedScenario, ACornerOfABladeThatIsForgottenIsCaught) {
  expect_caught("blade", "saddle", with_a_corner_cut_off, &RobotTally::below);
}

TEST(SabotagedScenario, ACornerOfAConvexToolThatIsForgottenIsCaught) {
  expect_caught("convex_tool", "saddle", with_a_corner_cut_off, &RobotTally::below);
}

TEST(SabotagedScenario, AToolThatDoesNotGiveWayIsCaught) {
  expect_caught("stuck", "saddle", make<Frozen>, &RobotTally::below);
}

TEST(SabotagedScenario, AMarginThatIsTenTolerancesTooSmallIsCaught) {
  expect_caught("convex_tool", "saddle", make<Careless>, &RobotTally::below);
}

TEST(SabotagedScenario, MotionsThatOvershootAreCounted) {
  const RobotTally row = run("unlimited", "saddle", 2000, make<Overshooting>);
  EXPECT_GT(row.strayed, test::trials(100u));
  EXPECT_GE(breaches(row), row.strayed);
}

TEST(SabotagedScenario, AStepThatStandsStillForNothingIsCounted) {
  const RobotTally lazy = run("approach", "saddle", 2000, make<Frozen>);
  EXPECT_GT(lazy.movable, lazy.samples / 4);
}

TEST(VerifyScenario, IsChosenByNameAndUnknownNamesSuggest) {
  const test::CommandFolder folder;
  const test::ProcessOutcome outcome =
      folder.run("verify cortex --scenario tip_guides,convex_tool --cycles 200 --speed 1");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "No breach in 400 cycles.");
  folder.expect_refused("verify --scenario guide", "did you mean 'guides'");
}

}  // namespace
}  // namespace keepout::app
