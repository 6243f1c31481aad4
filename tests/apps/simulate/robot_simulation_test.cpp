// SPDX-License-Identifier: BSD-3-Clause
// keepout simulate --robot: each mode makes the same strokes, and each body is judged.

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "apps/command_process.h"
#include "keepout/oracle/safety_oracle.h"
#include "shared/columns.h"
#include "shared/named_mesh.h"

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

TEST(SimulateRobot, AMonitorChangesNoCertifiedStepAndRefusesLinearizedStepsThatBreakThePromise) {
  const test::CommandFolder folder;
  const std::string arguments = "--strokes 3 --cycles 100 --speed 5 ";
  const Json alone = record_of_robot(folder, arguments);
  const Json monitored = record_of_robot(folder, arguments + "--monitor true");
  EXPECT_FALSE(alone["settings"].contains("monitor"));
  EXPECT_TRUE(monitored["settings"].contains("monitor"));
  for (std::size_t r = 0; r < 4; ++r) {
    const Json& row = alone["rows"][r];
    const Json& same = monitored["rows"][r];
    if (row["mode"] != "linearized") {
      EXPECT_EQ(row, same);
      continue;
    }
    EXPECT_GT(row["below"], 0U);
    EXPECT_EQ(same["below"], 0U);
    EXPECT_GT(same["refused"], row["refused"]);
  }
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

/// Returns the depth of the deepest of many points of a segment inside a surface. [mm]
double deepest_of(const oracle::SafetyOracle& surface, const Vec3& from, const Vec3& to) {
  double depth = -1.0;
  for (int i = 0; i <= 4000; ++i) {
    const Vec3 point = from + i / 4000.0 * (to - from);
    if (surface.inside(point).value_or(false)) depth = std::max(depth, surface.distance(point));
  }
  return depth;
}

TEST(SimulateRobot, ADepthIsThatOfTheAxisTooAndABodyInsideCounts) {
  const test::CommandFolder folder;
  const Json record = record_of_robot(folder, "--strokes 3 --cycles 200 --speed 5");
  oracle::SafetyOracle surface(load_named_mesh("gear", {}).mesh);
  int deep = 0, whole = 0;
  for (const Json& stroke : record["meshes"][0]["strokes"]) {
    const Json& unguarded = stroke["runs"][3];
    ASSERT_EQ(unguarded["mode"], "none");
    for (std::size_t cycle = 9; cycle < 200; cycle += 10) {
      const auto place = [&](std::size_t body) {
        const Json& at = unguarded["places"][cycle][body];
        return Vec3(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
      };
      for (std::size_t body = 1; body < 3; ++body) {
        const double depth = deepest_of(surface, place(body - 1), place(body));
        const double radius = record["bodies"][body]["radius_mm"];
        const Json& clearance = unguarded["clearance_mm"][cycle][body];
        const double told = clearance.is_null() ? 1.0 : clearance.get<double>();
        if (depth > 0.02) {
          // Places are rounded, and the judge sees four other poses of the cycle.
          EXPECT_LE(told, -(radius + depth) + 0.02);
          EXPECT_GE(told, -(radius + depth) - 0.02);
          ++deep;
          whole += surface.check(place(body - 1), place(body), 0.0).crosses ? 0 : 1;
        } else {
          EXPECT_GE(told, -radius - 0.04);
        }
      }
    }
  }
  EXPECT_GT(deep, 10);
  EXPECT_GT(whole, 0);
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
