// SPDX-License-Identifier: BSD-3-Clause
// keepout bench --speed, as a user runs it, on small meshes.

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "apps/command_process.h"
#include "bench/speed/speed.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/real_mesh.h"

namespace keepout::test {
namespace {

using nlohmann::json;

class SpeedCommand : public testing::Test {
 protected:
  /// Links the sample meshes; meshes made from them go into this folder.
  void SetUp() override {
    std::filesystem::create_directory_symlink(fixture_cache() / "fixtures",
                                              folder.file("fixtures"));
    if (const char* cache = std::getenv("KEEPOUT_CACHE")) before = cache;
    ::setenv("KEEPOUT_CACHE", folder.path().c_str(), 1);
  }
  void TearDown() override {
    before ? ::setenv("KEEPOUT_CACHE", before->c_str(), 1) : ::unsetenv("KEEPOUT_CACHE");
  }

  json read(const std::string& name) const { return json::parse(folder.contents(name)); }

  /// Returns what docs/figures prints of a record: tables in Markdown, and single figures.
  std::string figures_of(const std::string& json_file) const {
    const std::string script =
        "python3 '" KEEPOUT_FIGURES "' --show " + folder.file(json_file).string();
    EXPECT_EQ(std::system((script + " > " + folder.file("figures.md").string()).c_str()), 0);
    return folder.contents("figures.md");
  }

  CommandFolder folder;
  std::optional<std::string> before;
};

TEST_F(SpeedCommand, KeepsWhatItHasMeasuredWhenItIsInterrupted) {
  const ProcessOutcome outcome =
      folder.interrupted({KEEPOUT_COMMAND, "bench", "--speed", "--quick", "--triangles", "4000",
                          "--json", "s.json", "--out", "s.html"},
                         "sphere query");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "interrupted, so only a part of the table");
  const json record = read("s.json");
  EXPECT_EQ(record["complete"], false);
  EXPECT_GE(record["rows"].size(), 1u);
  EXPECT_CONTAINS(folder.contents("s.html"), "interrupted, so only a part of the table");
}

TEST_F(SpeedCommand, MeasuresEveryRowAndSaysWhatFallsShort) {
  const ProcessOutcome outcome = succeeded(folder.run(
      "bench --speed --quick --triangles 4000 --steps 3000 --largest 80000 --json s.json "
      "--out s.html"));  // a missed target is no failure
  const json record = read("s.json");
  EXPECT_EQ(record["mesh"], "bunny, 4,000 triangles");
  const std::string figures = figures_of("s.json");
  const std::size_t begin = figures.find("| work: compared |");
  ASSERT_NE(begin, std::string::npos) << figures;
  const std::string table = figures.substr(begin, figures.find("\nunmet:") - begin);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(table, '\n')), 1 + record["rows"].size())
      << table;

  std::set<std::string> counted;
  for (const json& row : record["rows"]) {
    const std::string name = row["work"].get<std::string>() + ": " + row["compared"].dump();
    if (row["figure"].is_null()) {
      EXPECT_TRUE(row["met"].is_null()) << name;
      EXPECT_FALSE(row["remark"].get<std::string>().empty()) << name;
      EXPECT_LACKS(row["remark"].get<std::string>(), "not timed")
          << name << row["remark"] << ": answers must agree";
      continue;
    }
    const bool at_least = row["demanded"].contains("at_least");
    const double figure = row["figure"];
    const double demanded = row["demanded"][at_least ? "at_least" : "at_most"];
    EXPECT_EQ(row["met"], at_least ? figure >= demanded : figure <= demanded) << name;
    for (const json& side : row["sides"]) EXPECT_GT(side["us"]["p50"], 0.0) << name;
    for (const char* what : {"page faults", "allocations", "locks"}) {
      if (row["compared"] != what) continue;
      counted.insert(what);
      EXPECT_EQ(figure, 0.0) << "of every step: " << what;
    }
  }
  EXPECT_EQ(counted.size(), app::counts_calls() ? 3u : 1u);
  std::size_t at_5_mm = 0;
  for (const json& query : record["queries"]) at_5_mm += query["radius"] == 5.0 ? 1 : 0;
  EXPECT_EQ(at_5_mm, index_backends().size() - 1) << "all but brute force";
  for (const char* words : {"at least 500x", "demanded", "Short of what is demanded:"}) {
    EXPECT_CONTAINS(outcome.output, words) << words;
  }

  for (const char* which : {"steps", "nothing"}) {
    const json& times = record["histogram"][which];
    EXPECT_EQ(times["total"], 3000);
    std::size_t sum = 0;
    for (const json& bin : times["bins"]) sum += bin[1].get<std::size_t>();
    EXPECT_EQ(sum, 3000u) << which;
    EXPECT_GE(times["at_most_ns"]["p999"], times["at_most_ns"]["p50"]) << which;
  }
  const std::string words = record["account"][0];
  EXPECT_TRUE(words.starts_with("3,000 certified steps in contact: 99 % within ")) << words;
  EXPECT_CONTAINS(outcome.output, words);
  EXPECT_CONTAINS(outcome.output, record["headline"].get<std::string>());
}

TEST_F(SpeedCommand, RefusesWhatItHasNoUseFor) {
  folder.expect_refused("bench --speed --index pd_tree", "--index");
  folder.expect_refused("bench --speed --mesh cube.stl", "--mesh");
  folder.expect_refused("bench --speed --csv s.csv", "--csv");
  folder.expect_refused("bench --speed --fast", "--fast");
  folder.expect_refused("bench --speed --steps 0", "--steps");
  folder.expect_refused("bench --speed --triangles 4000,5000", "--triangles");
  folder.expect_refused("bench --speed --json no/such/folder.json", "no/such");
  folder.expect_refused("bench --speed --json s.html --out s.html", "--json");
  folder.expect_refused("bench --quick", "--speed");
  folder.expect_refused("bench --largest 20000", "--speed");
}

TEST_F(SpeedCommand, SaysWhichFixtureIsMissing) {
  std::filesystem::remove(folder.file("fixtures"));
  folder.expect_refused("bench --speed --quick", "bunny");
  EXPECT_FALSE(std::filesystem::exists(folder.file("keepout-bench.html")));
}

}  // namespace
}  // namespace keepout::test
