// SPDX-License-Identifier: BSD-3-Clause
// keepout bench, as a user runs it.

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "apps/command_process.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/simd_target.h"
#include "keepout/solvers/registry.h"

namespace keepout::test {
namespace {

using nlohmann::json;

class BenchCommand : public testing::Test {
 protected:
  void SetUp() override { write_binary_stl(folder.file("cube.stl"), make_cube(5.0)); }

  json read(const std::string& name) const {
    return json::parse(folder.contents(name)).at("benchmark");
  }

  CommandFolder folder;
};

TEST_F(BenchCommand, ListsEveryPart) {
  const ProcessOutcome outcome = succeeded(folder.run("bench --list"));
  for (const IndexBackend& index : index_backends()) {
    EXPECT_CONTAINS(outcome.output, index.name) << index.name;
  }
  for (const SolverBackend& solver : solver_backends()) {
    EXPECT_CONTAINS(outcome.output, solver.name) << solver.name;
  }
  EXPECT_CONTAINS(outcome.output, "skull_1m");
}

TEST_F(BenchCommand, WritesOneRowForEachCombinationWithAllThatIsAskedOfIt) {
  const ProcessOutcome outcome = succeeded(folder.run(
      "bench --mesh cube.stl --index pd_tree,wide_bvh --radius 5,1 "
      "--activation paper,certified --queries 300 --seconds 5 --json b.json --csv b.csv"));
  const json benchmark = read("b.json");
  for (const char* key : {"processor", "cores", "memory_gib", "simd", "system", "compiler", "flags",
                          "build_type", "keepout", "libraries", "clock_ns"}) {
    EXPECT_TRUE(benchmark["machine"].contains(key)) << key;
  }
  ASSERT_EQ(benchmark["rows"].size(), 6u);
  std::map<std::string, std::set<std::string>> hashes;  // of each rule and radius
  for (const json& row : benchmark["rows"]) {
    EXPECT_TRUE(row["verified"]);
    EXPECT_EQ(row["mesh"], "cube.stl");
    EXPECT_EQ(row["queries"], 300);
    const bool searched = row["index"] == "wide_bvh" || row["activation"] == "paper";
    EXPECT_EQ(row["step_query_us"].is_null(), searched) << row;
    EXPECT_GT(row["build_cores"], 0.0);
    EXPECT_GT(row["load_cores"], 0.0);
    for (const char* stage :
         {"collect_us", "exact_us", "query_us", "activate_us", "solve_us", "step_us"}) {
      EXPECT_GT(row[stage]["p50"], 0.0) << stage;
      EXPECT_GE(row[stage]["max"], row[stage]["p99"]) << stage;
      EXPECT_TRUE(row[stage]["p999"].is_null()) << "300 samples do not tell";
    }
    hashes[row["activation"].get<std::string>() + row["radius"].dump()].insert(row["hash"]);
  }
  EXPECT_TRUE(benchmark["complete"]);
  EXPECT_EQ(benchmark["machine"]["simd"], std::string(simd_target()));
  EXPECT_GE(benchmark["others_cores"], 0.0);
  EXPECT_CONTAINS(outcome.output, "SIMD target " + std::string(simd_target()));
  EXPECT_EQ(hashes.size(), 3u);
  for (const auto& [combination, hash] : hashes) EXPECT_EQ(hash.size(), 1u) << combination;

  // The CSV file has the same numbers.
  std::istringstream csv(folder.contents("b.csv"));
  const auto cells = [&] {
    std::vector<std::string> all;
    std::string line;
    std::getline(csv, line);
    std::istringstream text(line + ',');
    for (std::string cell; std::getline(text, cell, ',');) all.push_back(cell);
    return all;
  };
  const std::vector<std::string> columns = cells();
  for (const json& row : benchmark["rows"]) {
    const std::vector<std::string> values = cells();
    ASSERT_EQ(values.size(), columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::size_t at = columns[c].find("_us_");
      const json timing = at == std::string::npos ? row.value(columns[c], json())
                                                  : row[columns[c].substr(0, at + 3)];
      const json told = timing.is_object() ? timing[columns[c].substr(at + 4)] : timing;
      if (told.is_number()) {
        EXPECT_EQ(std::stod(values[c]), told.get<double>()) << columns[c];
      }
    }
  }
  EXPECT_EQ(csv.peek(), EOF) << "one line for each row";
}

TEST_F(BenchCommand, ResamplesTheBunny) {
  succeeded(folder.run("bench --triangles 60000,70000 --index pd_tree --queries 50 --json b.json"));
  std::set<int> sizes;
  const json benchmark = read("b.json");
  for (const json& row : benchmark["rows"]) sizes.insert(row["triangles"].get<int>());
  EXPECT_EQ(sizes, (std::set<int>{60000, 70000}));
}

TEST_F(BenchCommand, SweepsOverSizesAndWritesAShortTable) {
  succeeded(
      folder.run("bench --sweep --triangles 10000,20000 --index wide_bvh,pd_tree --activation "
                 "paper --radius 1 "
                 "--queries 50 --json b.json --csv b.csv"));
  const json benchmark = read("b.json");
  ASSERT_EQ(benchmark["rows"].size(), 4u);
  for (const json& row : benchmark["rows"]) {
    EXPECT_LE(row["exact_us"]["p50"], row["query_us"]["max"]) << row;
  }
  std::istringstream csv(folder.contents("b.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "mesh,triangles,index,activation,solver,radius,build_s,bytes_per_triangle,queries,"
            "candidates_mean,"
            "hits_mean,collect_us_p50,collect_us_p99,exact_us_p50,exact_us_p99,query_us_p50,"
            "query_us_p99,step_us_p50,step_us_p99,verified");
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("bunny,10000,wide_bvh,paper,active_set,1")) << line;
  EXPECT_TRUE(line.ends_with(",true")) << line;
  folder.expect_refused("bench --sweep --speed", "--sweep");
}

TEST_F(BenchCommand, SaysWhatIsWrongWithTheArguments) {
  folder.expect_refused("bench --index pd-tree", "pd_tree");
  folder.expect_refused("bench --solver nlopt", "active_set");
  folder.expect_refused("bench --radius -1 --mesh cube.stl", "--radius");
  folder.expect_refused("bench --radius some --mesh cube.stl", "--radius");
  folder.expect_refused("bench --triangles 12", "--triangles");
  folder.expect_refused("bench --triangles 2000 --mesh cube.stl", "bunny");
  folder.expect_refused("bench --mesh nowhere.stl", "nowhere.stl");
  folder.expect_refused("bench --mesh cube.stl --json no/such/folder.json", "no/such");
  folder.expect_refused("bench --mesh cube.stl --json a.json --csv a.json", "--csv");
  folder.expect_refused("bench --mesh cube.stl --csv cube.stl", "cube.stl");
  folder.expect_refused("bench --poses somewhere", "contact");
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.json")));
  std::filesystem::create_directory(folder.file("other"));
  std::filesystem::copy(folder.file("cube.stl"), folder.file("other/cube.stl"));
  folder.expect_refused("bench --mesh cube.stl,other/cube.stl", "would have the same name");
}

TEST_F(BenchCommand, NamesTheMeshOfWhichNothingCanBeMeasured) {
  write_binary_stl(folder.file("line.stl"),
                   {{{0, 0, 0}, {9, 9, 9}, {20, 20, 20}}, {{0, 1, 2}, {2, 1, 0}}});
  folder.expect_refused("bench --mesh line.stl", "line.stl: none of its triangles has an area");
  folder.expect_refused("compare line.stl", "line.stl: none of its triangles has an area");
}

TEST_F(BenchCommand, RanksNoRowWhoseMotionsReachNoTriangle) {
  // Tips are 0.2 mm from the cube, so a sphere of 0.1 mm reaches no triangle.
  succeeded(folder.run(
      "bench --mesh cube.stl --index pd_tree,brute_force --activation paper --radius 0.1 "
      "--queries 100 --json b.json"));
  const json benchmark = read("b.json");
  for (const json& row : benchmark["rows"]) {
    EXPECT_TRUE(row["verified"]);
    EXPECT_EQ(row["hits_mean"], 0.0);
    EXPECT_EQ(row["reaching_share"], 0.0);
    EXPECT_NE(row["remark"], "");
  }
  EXPECT_TRUE(benchmark["fastest"].is_null());
}

TEST_F(BenchCommand, KeepsTheRowsThatAreFinishedWhenItIsInterrupted) {
  // Rows take so long that the signal after the first one arrives before all are finished.
  const ProcessOutcome outcome =
      folder.interrupted({KEEPOUT_COMMAND,    "bench",        "--mesh",    "cube.stl", "--index",
                          "wide_bvh,pd_tree", "--activation", "paper",     "--radius", "5,1",
                          "--queries",        "200000",       "--seconds", "5",        "--json",
                          "b.json",           "--csv",        "b.csv",     "--out",    "b.html"},
                         "\n5      wide_bvh");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "were finished, and are kept in b.html, b.json and b.csv");
  const json benchmark = read("b.json");
  EXPECT_EQ(benchmark["complete"], false);
  EXPECT_EQ(benchmark["planned_rows"], 4);
  const std::size_t rows = benchmark["rows"].size();
  EXPECT_GE(rows, 1u);
  EXPECT_LT(rows, 4u);
  for (const json& row : benchmark["rows"]) EXPECT_TRUE(row["verified"]) << "whole rows only";
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(folder.contents("b.csv"), '\n')), rows + 1);
  EXPECT_CONTAINS(folder.contents("b.html"), "planned_rows");
}

TEST_F(BenchCommand, WritesNothingWhenItIsInterruptedBeforeAnyRow) {
  const ProcessOutcome outcome =
      folder.interrupted({KEEPOUT_COMMAND, "bench", "--mesh", "cube.stl", "--queries", "200000",
                          "--seconds", "5", "--json", "b.json", "--out", "b.html"},
                         "SIMD target");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "nothing was written");
  EXPECT_FALSE(std::filesystem::exists(folder.file("b.json")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("b.html")));
}

TEST_F(BenchCommand, TellsOfAMistypedMeshBeforeItMeasuresAnother) {
  const ProcessOutcome outcome = folder.run("bench --mesh cube.stl,cubes.stl --json b.json");
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "cubes.stl: there is no such file");
  EXPECT_LACKS(outcome.output, "SIMD target") << "nothing was begun";
  EXPECT_FALSE(std::filesystem::exists(folder.file("b.json")));
}

TEST_F(BenchCommand, KeepsTheRowsBeforeAMeshThatIsBroken) {
  std::ofstream(folder.file("broken.stl")) << "solid broken";
  const ProcessOutcome outcome = folder.run(
      "bench --mesh cube.stl,broken.stl --index pd_tree --activation paper --radius 5 "
      "--queries 50 --json b.json --csv b.csv --out b.html");
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_CONTAINS(outcome.output,
                  "1 of 2 rows were finished, and are kept in b.html, b.json and "
                  "b.csv");
  EXPECT_CONTAINS(outcome.output, "keepout: broken.stl: ");
  const json benchmark = read("b.json");
  EXPECT_EQ(benchmark["complete"], false);
  ASSERT_EQ(benchmark["rows"].size(), 1u);
  EXPECT_EQ(benchmark["rows"][0]["mesh"], "cube.stl");
  EXPECT_TRUE(std::filesystem::exists(folder.file("b.html")));
  EXPECT_TRUE(std::filesystem::exists(folder.file("b.csv")));
  folder.expect_refused("bench --mesh broken.stl --json none.json", "broken.stl");
  EXPECT_FALSE(std::filesystem::exists(folder.file("none.json"))) << "there is nothing to keep";
}

TEST_F(BenchCommand, SaysWhenMoreTrianglesAreInReachThanItHasRoomFor) {
  Surface crowd{{Vec3(0, 0, 0), Vec3(90, 0, 0), Vec3(0, 90, 0)}, {}};
  crowd.triangles.assign(300'000, {0, 1, 2});
  write_binary_stl(folder.file("crowd.stl"), crowd);
  succeeded(
      folder.run("bench --mesh crowd.stl --index pd_tree --activation paper --radius 5,0.01 "
                 "--queries 20 --json b.json"));
  const json benchmark = read("b.json");
  ASSERT_EQ(benchmark["rows"].size(), 2u);
  EXPECT_FALSE(benchmark["rows"][0]["verified"]);
  EXPECT_CONTAINS(benchmark["rows"][0]["remark"].get<std::string>(), "in reach");
  EXPECT_FALSE(benchmark["rows"][0]["wrong"]);
  EXPECT_TRUE(benchmark["rows"][1]["verified"]) << "the others are measured all the same";
}

}  // namespace
}  // namespace keepout::test
