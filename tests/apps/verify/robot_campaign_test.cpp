// SPDX-License-Identifier: BSD-3-Clause
// keepout verify --robot: that the joint-space step keeps what it promises, and that the judge
// would see it if it did not.

#include <initializer_list>
#include <numeric>

#include "apps/command_process.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/robots.h"
#include "meshes.h"
#include "small_campaign.h"
#include "trials.h"
#include "verify/robot/campaign.h"
#include "verify/robot/judge.h"

namespace keepout::app {
namespace {

template <class Count>
std::uint64_t sum(const std::vector<RobotTally>& rows, Count RobotTally::*count) {
  return std::accumulate(rows.begin(), rows.end(), std::uint64_t{0},
                         [&](std::uint64_t all, const RobotTally& row) {
                           return all + static_cast<std::uint64_t>(row.*count);
                         });
}

class RobotCampaignWith : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Robots, RobotCampaignWith, testing::Values("psm", "seven_joint_arm"),
                         by_name);

TEST_P(RobotCampaignWith, NoCycleComesTooCloseOrBreaksAJointsLimit) {
  std::vector<Arena> arenas{arena_of("cortex"), arena_of("thin_plates"), arena_of("crown")};
  try {
    fixture_path("airway");
    arenas.push_back(named_arena("airway", "wide_bvh"));
  } catch (const Error&) {  // not there: what is generated has to do
  }
  const auto rows =
      run_campaign({.robot = GetParam(), .cycles = 1000, .seed = 20261123}, arenas, go_on);
  EXPECT_EQ(rows.size(), 5 * arenas.size());
  for (const RobotTally& row : rows) {
    const std::string where = row.mesh + ", " + row.scenario;
    EXPECT_EQ(row.below, 0u) << where << ": " << row.least_beyond;
    EXPECT_EQ(row.limits_broken, 0u) << where;
    EXPECT_TRUE(row.cycles == 1000u || row.is_out_of_starts) << where;
  }
  // It is no walk in the park.
  EXPECT_GT(sum(rows, &RobotTally::cycles), 4000 * arenas.size());
  EXPECT_GT(sum(rows, &RobotTally::blocked), 100 * arenas.size());
  EXPECT_GT(sum(rows, &RobotTally::rows), 1000 * arenas.size());
  EXPECT_GT(sum(rows, &RobotTally::recoveries), 0u);
  EXPECT_GT(sum(rows, &RobotTally::samples), 0u);
}

TEST(RobotCampaign, WhereTheLinearisedMotionIsCertifiedTheJudgeSeesItTooClose) {
  const auto rows = run_campaign(
      {.robot = "psm", .cycles = 4000, .speeds = {20.0}, .motion = CertifiedMotion::linearised},
      std::array{arena_of("gear")}, go_on);
  EXPECT_GT(rows.front().below, 0u);
  EXPECT_LT(rows.front().least_beyond, -1e-3);
  EXPECT_EQ(rows.front().limits_broken, 0u);
}

TEST(RobotCampaign, TheSameSeedGivesTheSameAndAnotherSeedDoesNot) {
  const auto tally = [](std::uint64_t seed) {
    return run_campaign({.robot = "psm", .cycles = 600, .speeds = {5.0}, .seed = seed},
                        std::array{arena_of("gear")}, go_on)
        .front();
  };
  const RobotTally one = tally(1);
  EXPECT_EQ(one.statuses, tally(1).statuses);
  EXPECT_EQ(one.least_beyond, tally(1).least_beyond);
  EXPECT_NE(one.least_beyond, tally(2).least_beyond);
}

/// A psm whose port is 120 mm above a plate: straight down, its tip is 3.7 mm beyond its insertion,
/// and the cutter's radius is 1 mm.
class RobotJudgeOverAPlate : public testing::Test {
 protected:
  using Positions = std::array<double, 6>;

  static Positions at(double insertion, double yaw = 0.0) { return {yaw, 0.0, insertion}; }
  RobotJudge judge_from(const Positions& positions) {
    return {{oracle::judged_psm(), arm_.chain().base(), {{tree_}}},
            arm_.chain(),
            random_,
            positions,
            options_,
            1e-9};
  }

  Instrument arm_ = psm({Vec3(0.3, 0.2, 120.0)});
  std::shared_ptr<const Mesh> mesh_ = mesh_of("flat_plate");
  std::shared_ptr<const oracle::TriangleTree> tree_ =
      std::make_shared<const oracle::TriangleTree>(mesh_);
  Random random_{1};
  InstrumentOptions options_{.margin = 0.2, .band = 0.002, .period = 10.0};
};

TEST_F(RobotJudgeOverAPlate, SeesABodyInTheMeshAtTheEndOfACycle) {
  const RobotVerdict verdict = judge_from(at(100.0)).judge(at(116.0));
  EXPECT_TRUE(verdict.is_below);
  EXPECT_FALSE(verdict.limits_broken);
  EXPECT_NEAR(verdict.least, 120.0 - 119.7 - 1.0, 1e-12);
  EXPECT_NEAR(verdict.beyond, verdict.least - 0.198, 1e-12);
}

TEST_F(RobotJudgeOverAPlate, SeesABodyInTheMeshAmidACycleWhoseEndsAreClear) {
  RobotJudge judge = judge_from(at(119.0, -0.3));
  EXPECT_TRUE(judge.is_recovered());
  EXPECT_TRUE(judge.judge(at(119.0, 0.3)).is_below);
  EXPECT_TRUE(judge.is_recovered());
}

TEST_F(RobotJudgeOverAPlate, HoldsAMotionToWhatWasToBeKeptToTheLastDigits) {
  const double lowest = 120.0 - 3.7 - 1.0 - 0.198;
  EXPECT_FALSE(judge_from(at(100.0)).judge(at(lowest - 1e-9)).is_below);
  EXPECT_TRUE(judge_from(at(100.0)).judge(at(lowest + 1e-8)).is_below);
}

TEST_F(RobotJudgeOverAPlate, WhatIsTooCloseMayNotComeCloserThanItEverWas) {
  RobotJudge judge = judge_from(at(115.6));  // 0.3 within the cutter
  EXPECT_FALSE(judge.is_recovered());
  EXPECT_FALSE(judge.judge(at(115.4)).is_below);
  EXPECT_FALSE(judge.judge(at(115.401)).is_below);  // less than the band
  EXPECT_TRUE(RobotJudge(judge).judge(at(115.41)).is_below);
  EXPECT_FALSE(judge.judge(at(115.0)).is_below);
  EXPECT_TRUE(judge.is_recovered());
  options_.margin += 0.5;
  judge.follow(options_);
  EXPECT_FALSE(judge.is_recovered());
  EXPECT_FALSE(judge.judge(at(115.0)).is_below);  // a raised margin is come up to
}

TEST_F(RobotJudgeOverAPlate, SeesBrokenLimitsOfJointsAndMotionsThatAreNone) {
  EXPECT_FALSE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.588)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.589)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(std::nan(""))).limits_broken);
  options_.period = 1e-3;
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(90.0, 0.0011)).limits_broken);
}

TEST(VerifyRobot, WritesARecordAndTellsOfMistakes) {
  const test::CommandFolder folder;
  const test::ProcessOutcome outcome = succeeded(folder.run(
      "verify cortex --robot psm --cycles 500 --speed 1,2 --seed 7 --json r.json --out r.html"));
  EXPECT_CONTAINS(outcome.output, "No breach in 2,500 cycles.");
  std::ifstream file(folder.file("r.json"));
  const Json record = Json::parse(file);
  EXPECT_EQ(record["keepout_record"], "verify_robot");
  EXPECT_EQ(record["complete"], true);
  EXPECT_EQ(record["settings"]["seed"], "7");
  EXPECT_EQ(record["rows"].size(), 5u);
  EXPECT_EQ(record["rows"][1]["speed"], 2.0);
  EXPECT_EQ(record["total"]["cycles"], 2500u);
  for (const auto& [arguments, told] : std::initializer_list<std::pair<const char*, const char*>>{
           {"--cycles 10", "--robot"},
           {"--robot pms", "did you mean 'psm'"},
           {"--robot psm --speed 0", "--speed"},
           {"--robot psm --margin 0", "--margin"},
           {"--robot psm --motion real", "--motion"},
           {"--robot psm --steps 10", "--steps"},
           {"--robot psm --merge r.json", "--merge"}}) {
    folder.expect_refused(std::string("verify sphere ") + arguments, told);
  }
}

}  // namespace
}  // namespace keepout::app
