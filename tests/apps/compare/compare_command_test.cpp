// SPDX-License-Identifier: BSD-3-Clause
// keepout compare as a user meets it.

#include <nlohmann/json.hpp>
#include <set>

#include "apps/command_process.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/version.h"

namespace keepout::test {
namespace {

using nlohmann::json;

class CompareCommand : public testing::Test {
 protected:
  void SetUp() override { write_binary_stl(folder.file("cube.stl"), make_cube(5.0)); }

  json read(const std::string& name) const { return json::parse(folder.contents(name)); }

  CommandFolder folder;
};

TEST_F(CompareCommand, HoldsEveryIndexToBruteForceAndSaysWhatItCameTo) {
  const ProcessOutcome outcome = succeeded(
      folder.run("compare cube.stl --poses 30 --problems 60 --pairs 20 --seed 3 --json c.json"));
  const json comparison = read("c.json")["comparison"];
  std::set<std::string> names, searched;
  for (const json& row : comparison["indices"]["rows"]) {
    names.insert(row["index"]);
    if (row["searched_by_the_rule"]) searched.insert(row["index"]);
    EXPECT_EQ(row["poses"], 30);
    EXPECT_EQ(row["missed"], 0);
    EXPECT_EQ(row["invented"], 0);
    EXPECT_EQ(row["steps_that_differ"], 0);
    EXPECT_LT(row["closest_point_error_mm"], 1e-12);
  }
  EXPECT_EQ(names.size(), index_backends().size() - 1);
  EXPECT_EQ(searched, (std::set<std::string>{"pd_tree", "wide_bvh"}))
      << "that is the form that users run";
  EXPECT_EQ(comparison["agree"], true);
  EXPECT_CONTAINS(outcome.output, read("c.json")["headline"].get<std::string>());
}

TEST_F(CompareCommand, WritesWhereItRanAndHowToDoItAgain) {
  const std::string arguments =
      "compare cube.stl --poses 6 --problems 10 --pairs 10 --seed 3 --json c.json";
  ASSERT_EQ(folder.run(arguments).status, 0);
  const json comparison = read("c.json");
  EXPECT_EQ(comparison["command"], "keepout " + arguments);
  EXPECT_EQ(comparison["seed"], 3);
  EXPECT_EQ(comparison["mesh"], "cube.stl");
  EXPECT_EQ(comparison["complete"], true);
  EXPECT_EQ(comparison["machine"]["keepout"], KEEPOUT_VERSION);
  EXPECT_FALSE(comparison["machine"]["processor"].get<std::string>().empty());
  EXPECT_EQ(comparison["date"].get<std::string>().size(),
            std::string("2026-01-01T00:00:00Z").size());
}

TEST_F(CompareCommand, KeepsWhatIsFinishedWhenItIsInterrupted) {
  const ProcessOutcome outcome =
      folder.run("compare cube.stl --poses 6 --problems 200000 --pairs 10 --json c.json",
                 "timeout --foreground --preserve-status --signal=INT 6");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "Interrupted");
  const json comparison = read("c.json")["comparison"];
  EXPECT_EQ(comparison["complete"], false);
  EXPECT_EQ(comparison["agree"], true);
  EXPECT_FALSE(comparison["indices"].empty()) << "they were finished";
  EXPECT_TRUE(comparison["narrow_phases"].empty());
}

}  // namespace
}  // namespace keepout::test
