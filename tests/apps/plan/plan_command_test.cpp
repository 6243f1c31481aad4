// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <nlohmann/json.hpp>

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

#if KEEPOUT_HAS_OMPL

using Json = nlohmann::json;

const std::string quick = "plan cortex.stl --seconds 20 --resolution 0.002 ";

TEST_F(PlanCommandTest, EveryPathOfKeepoutIsValidByTheOracle) {
  const ProcessOutcome outcome = succeeded(
      folder_.run(quick + "--problems 2 --json runs.json --csv runs.csv --out page.html"));
  EXPECT_CONTAINS(outcome.output, "certified");
  const Json record = Json::parse(std::ifstream(folder_.file("runs.json")));
  const Json& runs = record.at("runs");
  ASSERT_EQ(runs.size(), 8u);  // 2 problems, 4 checkers
  EXPECT_EQ(record.at("summaries").size(), 4u);
  EXPECT_EQ(record.at("settings").at("problems of each mesh"), "2");
  EXPECT_EQ(record.at("meshes").at(0).at("name"), "cortex.stl");
  EXPECT_CONTAINS(record.at("headline").get<std::string>(), "and 0 of 4 under keepout's")
      << record.at("headline");
  for (const Json& run : runs) {
    EXPECT_EQ(run["solved"] && !run["valid"], run.contains("too_near") && !run["too_near"].empty());
    if (run["checker"] != "certified" && run["checker"] != "sliding") continue;
    EXPECT_TRUE(run["solved"]) << run;
    EXPECT_TRUE(run["valid"]) << run;
    EXPECT_EQ(run["path"].front(), run["start"]);
    EXPECT_EQ(run["path"].back(), run["goal"]);
  }
  EXPECT_EQ(std::ranges::count(folder_.contents("runs.csv"), '\n'), 9);
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

TEST_F(PlanCommandTest, OfASmallMeshEachPathAlongTheGridIsSearchedOnlyWhereItLeads) {
  // The grid has 300 cells on a side, of which the mesh takes 40, so few pairs need such a detour.
  write_binary_stl(folder_.file("small.stl"), make_cube(3.0));
  const ProcessOutcome outcome =
      succeeded(folder_.run("plan small.stl --problems 12 --seconds 1 --resolution 0.01 --quiet "
                            "--json runs.json"));
  EXPECT_CONTAINS(outcome.output, "certified");
  EXPECT_CONTAINS(outcome.output, "under keepout's");
  const Json record = Json::parse(std::ifstream(folder_.file("runs.json")));
  ASSERT_EQ(record.at("runs").size(), 48u);
  for (const Json& run : record.at("runs")) EXPECT_GE(run.at("detour"), 1.3);
}

TEST_F(PlanCommandTest, CountsAResolutionOnce) {
  succeeded(folder_.run(
      "plan cortex.stl --seconds 1 --resolution 0.01,0.01 --problems 1 --json runs.json"));
  const Json record = Json::parse(std::ifstream(folder_.file("runs.json")));
  EXPECT_EQ(record.at("checkers"), Json({"sampled 1 %", "widened 1 %", "certified", "sliding"}));
  EXPECT_EQ(record.at("runs").size(), 4u);
}

TEST_F(PlanCommandTest, EveryPlannerRuns) {
  for (const char* planner : {"RRT", "PRM", "BITstar"}) {
    succeeded(folder_.run(quick + "--problems 1 --simplify --planner " + planner));
  }
}

TEST_F(PlanCommandTest, FailsIfNoPathWasFound) {
  const ProcessOutcome outcome =
      folder_.run("plan cortex.stl --problems 1 --seconds 1e-9 --resolution 0.002");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_CONTAINS(outcome.output, "no path was found, so nothing was tested: raise --seconds");
}

TEST_F(PlanCommandTest, NoPathOfAWholeInstrumentUnderCertifiedCheckingComesTooClose) {
  const ProcessOutcome outcome = succeeded(folder_.run(
      "plan gear --robot psm --problems 1 --seeds 2 --seconds 20 --resolution 0.02,0.01 "
      "--json runs.json --csv runs.csv --out page.html"));
  EXPECT_CONTAINS(outcome.output, "and 0 of 2 under keepout's");
  const Json record = Json::parse(std::ifstream(folder_.file("runs.json")));
  EXPECT_EQ(record.at("keepout_record"), "plan_robot");
  EXPECT_EQ(record.at("robot"), "psm");
  const Json& rows = record.at("summaries");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].at("checker"), "certified");
  EXPECT_EQ(rows[2].at("solved"), 2);
  EXPECT_EQ(rows[2].at("too_close"), 0);
  EXPECT_EQ(rows[2].at("unproven"), 0);
  EXPECT_GE(rows[2].at("motions"), 2 * 2) << "the straight motion is not free";
  const Json& runs = record.at("runs");
  ASSERT_EQ(runs.size(), 6u);  // 3 checkers, 2 seeds
  for (const Json& run : runs) {
    EXPECT_GE(run.at("advance_mm"), 30.0);
    if (!run.at("solved")) continue;
    EXPECT_EQ(run.at("path").front(), run.at("start"));
    EXPECT_EQ(run.at("path").back(), run.at("goal"));
    EXPECT_EQ(run.at("motions").get<std::size_t>() + 1, run.at("path").size());
    // A sampled motion that violates the margin is not proved either.
    EXPECT_LE(run.at("too_close"), run.at("unproven"));
  }
  EXPECT_NE(runs[4].at("path"), runs[5].at("path")) << "another seed, another path";
  EXPECT_EQ(std::ranges::count(folder_.contents("runs.csv"), '\n'), 7);
  EXPECT_GT(std::filesystem::file_size(folder_.file("page.html")), 1000u);
}

TEST_F(PlanCommandTest, SaysWhatIsWrong) {
  folder_.expect_refused("plan cortex.stl --planner XYZ", "RRTConnect");
  folder_.expect_refused("plan cortex.stl --resolution nan", "fraction of the extent");
  folder_.expect_refused("plan cortex.stl --seconds 0", "seconds above 0");
  folder_.expect_refused("plan cortex.stl --range 1e-9",
                         "--range: expected 0 or a number from 0.01 to 1e30, not '1e-9'");
  write_binary_stl(folder_.file("line.stl"),
                   {{{0, 0, 0}, {9, 9, 9}, {20, 20, 20}}, {{0, 1, 2}, {2, 1, 0}}});
  for (const char* tool : {"", " --robot psm"}) {
    folder_.expect_refused(std::string("plan line.stl") + tool,
                           "line.stl: none of its triangles has an area");
  }
  folder_.expect_refused("plan cortex.stl --tool-radius 80", "problems were found");
  folder_.expect_refused("plan cortex.stl --json cortex.stl", "same file");
  folder_.expect_refused("plan --inside", "MESH");
  folder_.expect_refused("plan none.stl", "none.stl");
  folder_.expect_refused("plan cube --robot pms", "psm");
  folder_.expect_refused("plan cube --robot psm --tool-radius 1", "--tool-radius");
  folder_.expect_refused("plan cube --robot psm --inside", "--inside");
  folder_.expect_refused("plan cube --seeds 3", "--robot");
}

#else

TEST_F(PlanCommandTest, WithoutOmplItSaysWhatToInstall) {
  const ProcessOutcome outcome = folder_.run("plan cortex.stl");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_CONTAINS(outcome.output, "libompl-dev");
}

#endif

}  // namespace
}  // namespace keepout::test
