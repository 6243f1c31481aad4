// SPDX-License-Identifier: BSD-3-Clause
// keepout simulate --robot: each mode makes the same strokes, and each body is judged.

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "apps/command_process.h"
#include "shared/columns.h"

namespace keepout::app {
namespace {

/// Runs the command; returns its record.
Json record_of_robot(const test::CommandFolder& folder, const std::string& arguments) {
  const test::ProcessOutcome outcome =
      succeeded(folder.run("simulate gear --robot psm --json r.json --out r.html " + arguments));
  EXPECT_CONTAINS(outcome.output, "The certified step kept shaft, wrist and jaw off");
  std::ifstream file(folder.file("r.json"));
  Json record = Json::parse(file);
  EXPECT_EQ(record["keepout_record"], "simulate_robot");
  return record;
}

TEST(SimulateRobot, WhatIsCertifiedKeepsAllBodiesOutAndNothingElseDoes) {
  const test::CommandFolder folder;
  const Json record = record_of_robot(folder, "--strokes 6 --cycles 300 --speed 1,20");
  const Json& rows = record["rows"];
  ASSERT_EQ(rows.size(), 8u);
  for (const Json& row : rows) {
    EXPECT_EQ(row["cycles"], 1800u);
    EXPECT_EQ(row["limits_broken"], 0u);
    for (const Json& body : record["bodies"]) {
      const std::string name = body["name"].get<std::string>();
      EXPECT_LE(row[name + "_deepest_mm"].get<double>(), body["radius_mm"].get<double>() + 1e-9);
      EXPECT_EQ(row[name + "_deepest_mm"] > 0.0, row[name + "_in_mesh"] > 0u);
      EXPECT_GE(row[name + "_below"], row[name + "_in_mesh"]);
      EXPECT_GE(row["below"], row[name + "_below"]);
      EXPECT_GE(row["in_mesh"], row[name + "_in_mesh"]);
    }
    EXPECT_TRUE(row["mode"] != "certified" || row["below"] == 0u) << row;
    EXPECT_TRUE(row["mode"] != "tip only" || row["shaft_deepest_mm"] > 1.0) << row;
    EXPECT_TRUE(row["mode"] != "none" || row["in_mesh"] > 100u) << row;
  }
  EXPECT_EQ(rows[5]["mode"], "linearized");
  EXPECT_EQ(rows[5]["speed"], 20.0);
  EXPECT_GT(rows[5]["in_mesh"], 0u);
}

TEST(SimulateRobot, TheSameSeedGivesTheSameAndAnotherDoesNot) {
  const test::CommandFolder folder;
  const auto record = [&](const std::string& seed) {
    Json json = record_of_robot(folder, "--strokes 3 --cycles 100 --speed 5 --seed " + seed);
    for (const char* of_the_run : {"date", "command", "machine", "settings"}) {
      json.erase(of_the_run);
    }
    return json.dump();
  };
  const std::string one = record("1");
  EXPECT_EQ(one, record("1"));
  EXPECT_NE(one, record("2"));
}

TEST(SimulateRobot, KeepsAStrokeOfEachMannerThatBeginsAlikeInAllModes) {
  const test::CommandFolder folder;
  const Json record = record_of_robot(folder, "--strokes 4 --cycles 100 --speed 5");
  const Json& strokes = record["meshes"][0]["strokes"];
  ASSERT_EQ(strokes.size(), 3u);
  for (const Json& stroke : strokes) {
    ASSERT_EQ(stroke["runs"].size(), 4u);
    for (const Json& run : stroke["runs"]) {
      ASSERT_EQ(run["places"].size(), 100u);
      ASSERT_EQ(run["clearance_mm"].size(), 100u);
      EXPECT_EQ(run["places"][0].size(), 3u);
      EXPECT_EQ(run["places"][0], stroke["runs"][0]["places"][0]);  // the surface is 5 mm off
      const auto least = [](const Json& cycle) {
        double mm = 1.0;
        for (const Json& body : cycle) mm = std::min(mm, body.is_null() ? 1.0 : body.get<double>());
        return mm;
      };
      const double worst = least(run["clearance_mm"][run["worst"].get<std::size_t>()]);
      for (const Json& cycle : run["clearance_mm"]) EXPECT_GE(least(cycle), worst);
    }
  }
}

TEST(SimulateRobot, TellsOfMistakes) {
  const test::CommandFolder folder;
  for (const auto& [arguments, told] : std::initializer_list<std::pair<const char*, const char*>>{
           {"cube --robot pms", "did you mean 'psm'"},
           {"cube --speed 2", "--robot"},
           {"cube --robot psm --speed 0", "--speed"},
           {"cube --robot psm --activation paper", "cannot be given together"},
           {"cube --robot psm --radius 1", "cannot be given together"},
           {"cube sphere", "MESH: must be one mesh; only --robot takes several"},
           {"cub --robot psm", "did you mean 'cube'"}}) {
    folder.expect_refused(std::string("simulate ") + arguments, told);
  }
}

}  // namespace
}  // namespace keepout::app
