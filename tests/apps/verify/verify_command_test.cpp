// SPDX-License-Identifier: BSD-3-Clause
// The command keepout verify: options, shards, files.

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "apps/command_process.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/simd_target.h"

namespace keepout::app {
namespace {

using Outcome = test::ProcessOutcome;

class Verify : public testing::Test {
 protected:
  void SetUp() override {
    write_binary_stl(folder_.path() / "cube.stl", make_cube(10.0));
    write_binary_stl(folder_.path() / "terrain.stl", make_saddle_terrain(5.0));
  }

  Outcome run(const std::string& arguments, const std::string& environment = {}) const {
    return folder_.run("verify " + arguments, environment);
  }

  nlohmann::json read(const std::string& name) const {
    return nlohmann::json::parse(folder_.contents(name));
  }

  /// Removes the members that may differ between two runs.
  static nlohmann::json without_times(nlohmann::json result) {
    for (const char* key : {"shards", "date", "command"}) result.erase(key);
    result.erase("shard_count");
    result["total"].erase("seconds");
    for (nlohmann::json& mesh : result["meshes"]) mesh.erase("seconds");
    return result;
  }

  test::CommandFolder folder_;
};

TEST_F(Verify, ShardsAddUpToTheWhole) {
  const std::string both = "cube.stl terrain.stl --steps 5250 --seed 3 ";
  const Outcome whole = succeeded(run(both + "--json whole.json"));
  EXPECT_CONTAINS(whole.output, "No breach in 5,250 steps");
  const double trajectories = read("whole.json")["total"]["trajectories"];
  const std::string account = read("whole.json")["account"].dump();
  const std::string stated = account.substr(account.find("at most ") + 8);
  // If this fraction of all trajectories had a breach, none in this sample would have a probability
  // of 5 %. Rounding to two digits changes the bound by at most 5 %.
  const double bound = std::stod(stated) / 100;
  EXPECT_NEAR(std::log(0.05) / std::log1p(-bound), trajectories, 0.05 * trajectories);
  const std::string machine = read("whole.json")["shards"].dump();
  EXPECT_CONTAINS(machine, ", " + std::string(simd_target()) + ", ");
  for (const char* shard : {"1", "2", "3"}) {
    const std::string options = std::string("--shard ") + shard + "/3 --json " + shard + ".json";
    ASSERT_EQ(run(both + options).status, 0);
  }
  const Outcome merged = succeeded(run("--merge 3.json 1.json 2.json --json merged.json"));
  EXPECT_LACKS(merged.output, "Missing");
  EXPECT_EQ(without_times(read("merged.json")), without_times(read("whole.json")));
  EXPECT_EQ(read("merged.json")["shards"].size(), 3u);
  EXPECT_EQ(read("merged.json")["command"],
            "keepout verify --merge 3.json 1.json 2.json --json merged.json");
  EXPECT_EQ(read("merged.json")["complete"], true);
  EXPECT_LACKS(whole.output, "Incomplete");
}

TEST_F(Verify, WhatIsInterruptedKeepsWhatIsFinishedAndIsNotTakenForWhole) {
  for (const char* signal : {"INT", "TERM"}) {
    // Without --foreground, `timeout` sends two signals, and the second one ends the process.
    const Outcome outcome =
        run("cube.stl --steps 1e9 --shard 1/2 --json part.json",
            "timeout --foreground --preserve-status -k 30 -s " + std::string(signal) + " 2 ");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    const nlohmann::json part = read("part.json");
    const auto done = part["total"]["steps"].get<std::uint64_t>();
    EXPECT_GT(done, 0u);
    EXPECT_EQ(done % 500, 0u) << "a trajectory is done whole";
    EXPECT_EQ(part["steps"], 1'000'000'000u);
    EXPECT_EQ(part["steps_done"], done);
    EXPECT_EQ(part["complete"], false);
    EXPECT_EQ(part["shards"][0]["complete"], false);
    EXPECT_CONTAINS(outcome.output, " s on ");
    EXPECT_CONTAINS(outcome.output, ", interrupted\n");
    EXPECT_CONTAINS(outcome.output, "of the campaign's 1,000,000,000 steps are done");
  }
  const Outcome merged = run("--merge part.json --json merged.json");
  EXPECT_EQ(merged.status, 1);
  EXPECT_CONTAINS(merged.output, "Incomplete: ");
  EXPECT_CONTAINS(merged.output, "Missing: shard 2/2");
  EXPECT_EQ(read("merged.json")["complete"], false);
}

TEST_F(Verify, AMissingShardIsReported) {
  const std::string both = "cube.stl --steps 2000 --shard ";
  ASSERT_EQ(run(both + "1/3 --json 1.json").status, 0);
  ASSERT_EQ(run(both + "3/3 --json 3.json").status, 0);
  const Outcome merged = run("--merge 1.json 3.json");
  EXPECT_EQ(merged.status, 1);
  EXPECT_CONTAINS(merged.output, "Missing: shard 2/3");
  EXPECT_CONTAINS(merged.output, "the campaign is incomplete");
}

TEST_F(Verify, WhatDoesNotBelongTogetherIsNotMerged) {
  ASSERT_EQ(run("cube.stl --steps 1000 --shard 1/2 --json 1.json").status, 0);
  ASSERT_EQ(run("cube.stl --steps 1000 --shard 2/2 --seed 9 --json seed.json").status, 0);
  ASSERT_EQ(run("cube.stl --steps 1001 --shard 2/2 --json steps.json").status, 0);
  ASSERT_EQ(run("cube.stl --steps 1500 --shard 2/3 --json shards.json").status, 0);
  ASSERT_EQ(run("terrain.stl --steps 1000 --shard 2/2 --json mesh.json").status, 0);
  nlohmann::json other = read("1.json");
  other["version"] = "99.0";
  folder_.write("version.json", other.dump());
  other["campaign_format"] = 99;
  folder_.write("format.json", other.dump());
  folder_.write("cut.json", other.dump().substr(0, 100));
  folder_.write("else.json", "{\"a\": 1}");
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {"seed.json", "seeds"},          {"steps.json", "steps"},
      {"shards.json", "shards"},       {"mesh.json", "meshes"},
      {"version.json", "versions"},    {"format.json", "format 99"},
      {"cut.json", "not a whole"},     {"else.json", "not a whole"},
      {"none.json", "cannot be read"}, {"1.json", "both contain shard 1/2"}};
  for (const auto& [file, told] : mistakes) {
    const Outcome outcome = run("--merge 1.json " + file);
    EXPECT_EQ(outcome.status, 1) << file;
    EXPECT_CONTAINS(outcome.output, told) << file;
    EXPECT_CONTAINS(outcome.output, file);
  }
}

TEST_F(Verify, AResultWhoseNumbersCannotBeIsNotMerged) {
  ASSERT_EQ(run("cube.stl --steps 1000 --json whole.json").status, 0);
  const std::vector<std::pair<std::string, nlohmann::json>> damages{
      {"/total/breaches/penetration", -1},
      {"/total/breaches/penetration", 0.5},
      {"/meshes/0/breaches/penetration", 1},  // that the total does not have
      {"/meshes/0/statuses/free", -1},
      {"/meshes/0/seconds", -1.0},
      {"/total/steps", 1},
      {"/shard_count", -1},
      {"/shard_count", 1'000'000'000'000},
      {"/shards/0/index", 0},
      {"/shards/0/index", 2}};
  folder_.write("again.json", read("whole.json").dump());
  ASSERT_EQ(run("--merge again.json").status, 0);
  for (const auto& [place, value] : damages) {
    nlohmann::json damaged = read("whole.json");
    damaged[nlohmann::json::json_pointer(place)] = value;
    folder_.write("damaged.json", damaged.dump());
    const Outcome outcome = run("--merge damaged.json");
    EXPECT_EQ(outcome.status, 1) << place << value;
    EXPECT_CONTAINS(outcome.output, "damaged.json: is not a whole") << place << value;
  }
}

TEST_F(Verify, MistakesAreReported) {
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {"none.stl", "none.stl"},
      {"cube.stl cube.stl", "named twice"},
      {"cube.stl --steps 0", "--steps"},
      {"cube.stl --steps 1.5", "--steps"},
      {"cube.stl --steps 1e13", "--steps"},
      {"cube.stl --steps many", "--steps"},
      {"cube.stl --steps -5", "--steps"},
      {"cube.stl --seed -1", "--seed"},
      {"cube.stl --shard 0/2", "--shard"},
      {"cube.stl --shard 3/2", "--shard"},
      {"cube.stl --shard 1", "--shard"},
      {"cube.stl --shard 1/2x", "--shard"},
      {"cube.stl --shard 1/9 --steps 1000", "only 2 trajectories"},
      {"cube.stl --index best", "--index"},
      {"cube.stl --json no/such/folder.json", "no/such/folder.json"},
      {"cube.stl --json cube.stl", "same file"},
      {"--merge a.json --steps 10", "--steps"},
      {"--merge a.json --shard 1/2", "--shard"},
      {"--merge a.json --json a.json", "same file"},
      {"cube.stl --stepps 10", "--stepps"},
      {"cube.stl --cycles 10", "--robot"},
      {"cube.stl --robot pms", "did you mean 'psm'"},
      {"cube.stl --robot psm --speed 0", "--speed"},
      {"cube.stl --robot psm --margin 0", "--margin"},
      {"cube.stl --robot psm --motion real", "--motion"},
      {"cube.stl --robot psm --steps 10", "--steps"},
      {"cube.stl --robot psm --merge r.json", "--merge"},
      {"--scenario guide", "did you mean 'guides'"}};
  for (const auto& [arguments, message] : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    EXPECT_CONTAINS(outcome.output, message) << arguments;
    EXPECT_LACKS(outcome.output, "least/tau") << "did it all the same";
    EXPECT_LACKS(outcome.output, "in tau") << "did it all the same";
  }
}

TEST_F(Verify, OfARobotWritesARecord) {
  const Outcome outcome = succeeded(
      run("cortex --robot psm --cycles 500 --speed 1,2 --seed 7 --json r.json --out r.html"));
  EXPECT_CONTAINS(outcome.output, "No breach in 2,500 cycles.");
  const nlohmann::json record = read("r.json");
  EXPECT_EQ(record["keepout_record"], "verify_robot");
  EXPECT_EQ(record["complete"], true);
  EXPECT_EQ(record["settings"]["seed"], "7");
  EXPECT_EQ(record["rows"].size(), 5u);
  EXPECT_EQ(record["rows"][1]["speed"], 2.0);
  EXPECT_EQ(record["total"]["cycles"], 2500u);
  // 1 - 0.05^(1 / 5) = 0.451: each row is one trajectory.
  EXPECT_CONTAINS(outcome.output, "at most 45 % of such trajectories have a breach: 5 independent");
}

TEST_F(Verify, ScenariosAreChosenByName) {
  const Outcome outcome =
      succeeded(run("cortex --scenario tip_guides,convex_tool --cycles 200 --speed 1"));
  EXPECT_CONTAINS(outcome.output, "No breach in 400 cycles.");
}

TEST_F(Verify, StepsMayBeWrittenWithAnExponent) {
  const Outcome outcome = succeeded(run("cube.stl --steps 1e3"));
  EXPECT_CONTAINS(outcome.output, "No breach in 1,000 steps");
}

TEST_F(Verify, FixturesThatAreNotThereAreNamed) {
  const Outcome outcome = succeeded(run("--steps 500", "KEEPOUT_CACHE=."));
  EXPECT_CONTAINS(outcome.output, "Missing: ");
  EXPECT_CONTAINS(outcome.output, "skull.stl");
}

}  // namespace
}  // namespace keepout::app
