// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/command_process.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"

namespace keepout::test {
namespace {

class PlanCommandTest : public testing::Test {
 protected:
  PlanCommandTest() { write_binary_stl(folder_.file("cortex.stl"), make_cortex(4.0, 1)); }

  CommandFolder folder_;
};

#ifdef KEEPOUT_HAS_OMPL

using Json = nlohmann::json;

const std::string quick = "plan cortex.stl --seconds 20 --resolution 0.002 ";

TEST_F(PlanCommandTest, EveryPathOfKeepoutIsValidByTheOracle) {
  const ProcessOutcome outcome =
      folder_.run(quick + "--problems 2 --json runs.json --csv runs.csv --out page.html");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("certified"), std::string::npos) << outcome.output;
  const Json record = Json::parse(std::ifstream(folder_.file("runs.json")));
  const Json& runs = record.at("runs");
  ASSERT_EQ(runs.size(), 8u);  // 2 problems, 4 checkers
  EXPECT_EQ(record.at("summaries").size(), 4u);
  EXPECT_EQ(record.at("settings").at("problems of each mesh"), "2");
  EXPECT_EQ(record.at("meshes").at(0).at("name"), "cortex.stl");
  EXPECT_NE(record.at("headline").get<std::string>().find("and 0 of 4 under keepout's"),
            std::string::npos)
      << record.at("headline");
  for (const Json& run : runs) {
    EXPECT_EQ(run["solved"] && !run["valid"], run.contains("too_near") && !run["too_near"].empty());
    if (run["checker"] != "certified" && run["checker"] != "sliding") continue;
    EXPECT_TRUE(run["solved"]) << run;
    EXPECT_TRUE(run["valid"]) << run;
    EXPECT_EQ(run["path"].front(), run["start"]);
    EXPECT_EQ(run["path"].back(), run["goal"]);
  }
  std::ifstream csv(folder_.file("runs.csv"));
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(csv), {}, '\n'), 9);
  EXPECT_GT(std::filesystem::file_size(folder_.file("page.html")), 1000u);
}

TEST_F(PlanCommandTest, TheSameSeedPlansTheSame) {
  const auto paths = [&](const std::string& more) {
    EXPECT_EQ(folder_.run(quick + "--problems 1 --json runs.json " + more).status, 0);
    std::vector<Json> result;
    const Json root = Json::parse(std::ifstream(folder_.file("runs.json")));
    for (const Json& run : root.at("runs")) {
      result.push_back(run.value("path", Json()));
    }
    return result;
  };
  const auto first = paths("--seed 5");
  EXPECT_EQ(first, paths("--seed 5"));
  EXPECT_EQ(first.size(), 4u);
  EXPECT_NE(first, paths("--seed 6"));
}

TEST_F(PlanCommandTest, EveryPlannerRuns) {
  for (const char* planner : {"RRT", "PRM", "BITstar"}) {
    const ProcessOutcome outcome =
        folder_.run(quick + "--problems 1 --simplify --planner " + planner);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
  }
}

TEST_F(PlanCommandTest, SaysWhatIsWrong) {
  const auto fails = [&](const std::string& arguments, const std::string& words) {
    const ProcessOutcome outcome = folder_.run("plan " + arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
  };
  fails("cortex.stl --planner XYZ", "RRTConnect");
  fails("cortex.stl --resolution nan", "share of the extent");
  fails("cortex.stl --seconds 0", "seconds above 0");
  fails("cortex.stl --tool-radius 80", "problems were found");
  fails("cortex.stl --json cortex.stl", "same file");
  fails("--inside", "MESH");
  fails("none.stl", "none.stl");
}

#else

TEST_F(PlanCommandTest, WithoutOmplItSaysWhatToInstall) {
  const ProcessOutcome outcome = folder_.run("plan cortex.stl");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.output.find("libompl-dev"), std::string::npos) << outcome.output;
}

#endif

}  // namespace
}  // namespace keepout::test
