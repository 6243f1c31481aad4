// SPDX-License-Identifier: BSD-3-Clause
// What keepout bench says in words of what it has really measured: each number is one
// of the record's, or follows from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "apps/command_process.h"
#include "bench/parts.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/solvers/registry.h"
#include "number_text.h"

namespace keepout::test {
namespace {

using app::grouped;
using app::mean_text;
using app::ratio_text;
using app::rounded;
using app::time_text;
using nlohmann::json;

const std::string no_break = "\u00a0";

/// Two sizes of one mesh and another mesh, measured once.
class MeasuredReport : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<CommandFolder>();
    write_binary_stl(folder->file("cube.stl"), make_cube(20.0));
    std::string indices = "wide_bvh,pd_tree", solvers = "active_set";
    for (const IndexBackend& index : app::indices()) {
      if (index.name == "fcl_obbrss") indices += ",fcl_obbrss";
    }
    for (const SolverBackend& solver : solver_backends()) {
      if (solver.name == "nlopt_slsqp") solvers += ",nlopt_slsqp";
    }
    outcome = folder->run("bench --mesh bunny,cube.stl --triangles 3000,12000 --index " + indices +
                          " --solver " + solvers +
                          " --activation paper,all_faces,certified --radius 5,0.25 --queries 200 "
                          "--seconds 5 --json b.json --csv b.csv");
    if (outcome.status != 0) return;
    record = json::parse(std::ifstream(folder->file("b.json")))["benchmark"];
  }
  static void TearDownTestSuite() { folder.reset(); }

  void SetUp() override { ASSERT_EQ(outcome.status, 0) << outcome.output; }

  /// What is found, of one kind of thing or of all.
  static std::vector<std::string> findings(const std::string& about = {}) {
    std::vector<std::string> all;
    for (const json& finding : record["findings"]) {
      if (about.empty() || finding["about"] == about) all.push_back(finding["text"]);
    }
    return all;
  }

  static std::vector<std::string> sentences() {
    std::vector<std::string> all = findings();
    all.push_back(record["headline"]);
    all.push_back(record["account"]);
    return all;
  }

  /// Whether the record says so somewhere.
  static bool is_said(const std::string& words) {
    return std::ranges::any_of(sentences(), [&](const std::string& text) {
      return text.find(words) != std::string::npos;
    });
  }

  static std::vector<json> rows_of(const json& wanted) {
    std::vector<json> result;
    for (const json& row : record["rows"]) {
      bool fits = true;
      for (const auto& [key, value] : wanted.items()) fits = fits && row[key] == value;
      if (fits) result.push_back(row);
    }
    return result;
  }

  static std::string time_of(const json& row, const std::string& stage) {
    return time_text(row[stage]["p50"]);
  }

  /// Each mesh at its largest.
  static std::map<std::string, std::size_t> largest() {
    std::map<std::string, std::size_t> result;
    for (const json& row : record["rows"]) {
      std::size_t& most = result[row["mesh"]];
      most = std::max(most, row["triangles"].get<std::size_t>());
    }
    return result;
  }

  static inline std::unique_ptr<CommandFolder> folder;
  static inline ProcessOutcome outcome;
  static inline json record;
};

/// What may stand before a unit: figures of the record, in the form in which they are told.
class Figures {
 public:
  explicit Figures(const json& record) {
    const json& rows = record["rows"];
    add("of", rows.size());
    add("rows", rows.size());
    add("cores", record["machine"]["cores"].get<std::size_t>());
    of_unit_["cores"].insert(rounded(record["others_cores"], 2));
    of_unit_["of"].insert(rounded(record["others_cores"], 2));
    // Limits that are stated, and what Li et al. published.
    of_unit_["%"] = {"1", "99"};
    of_unit_["kHz"] = {"1", "7.73", "0.18"};
    of_unit_["mm"] = {"5"};
    of_unit_["triangles"] = {"51,978", "989,376"};
    of_unit_["and"] = {"51,978"};
    for (const json& row : rows) add_row(row);
    for (const json& row : rows) {
      for (const json& other : rows) {
        if (row["mesh"] == other["mesh"]) add_ratios(row, other);
      }
    }
  }

  bool hold(const std::string& unit, const std::string& number) const {
    const auto known = of_unit_.find(unit);
    return known != of_unit_.end() && known->second.contains(number);
  }

 private:
  static constexpr std::array stages = {"collect_us",    "query_us",    "step_us",
                                        "step_query_us", "activate_us", "solve_us"};

  void add(const std::string& unit, std::size_t count) { of_unit_[unit].insert(grouped(count)); }

  void add_row(const json& row) {
    for (const std::string unit : {"triangles", "and", "on"}) {
      add(unit, row["triangles"].get<std::size_t>());
    }
    for (const std::string unit : {"steps", "motions"}) {
      add(unit, row["queries"].get<std::size_t>());
    }
    of_unit_["planes"].insert(mean_text(row["planes_mean"]));
    of_unit_["s"].insert({rounded(row["build_s"]), rounded(row["load_s"])});
    of_unit_["cores"].insert({rounded(row["build_cores"], 2), rounded(row["load_cores"], 2)});
    const std::string bytes = rounded(row["bytes_per_triangle"]);
    of_unit_["bytes"].insert(bytes);
    of_unit_["."].insert(bytes);
    if (!row["radius"].is_null()) of_unit_["mm"].insert(app::trimmed(row["radius"]));
    if (row["step_us"].is_null()) return;
    of_unit_["kHz"].insert(rounded(1e3 / row["step_us"]["p50"].get<double>()));
    double sum = 0.0;
    const auto median = [&](const char* stage) {
      return row[stage].is_null() ? 0.0 : row[stage]["p50"].get<double>();
    };
    for (const char* stage : {"step_query_us", "activate_us", "solve_us"}) sum += median(stage);
    for (const char* stage : {"step_query_us", "activate_us", "solve_us"}) {
      of_unit_["%"].insert(rounded(100.0 * median(stage) / sum, 2));
    }
    for (const char* stage : stages) {
      if (row[stage].is_null()) continue;
      const std::string text = time_text(row[stage]["p50"]);
      const std::size_t space = text.find(no_break);
      of_unit_[text.substr(space + no_break.size())].insert(text.substr(0, space));
    }
  }

  void add_ratios(const json& row, const json& other) {
    of_unit_["times"].insert(
        ratio_text(row["triangles"].get<double>() / other["triangles"].get<double>()));
    for (const char* stage : stages) {
      if (row[stage].is_null() || other[stage].is_null()) continue;
      of_unit_["times"].insert(
          ratio_text(row[stage]["p50"].get<double>() / other[stage]["p50"].get<double>()));
    }
  }

  std::map<std::string, std::set<std::string>> of_unit_;
};

TEST_F(MeasuredReport, EachNumberInASentenceIsOneOfTheRecord) {
  const Figures figures(record);
  // Names and quotations are no figures.
  std::vector<std::string> names;
  for (const auto& [name, what] : record["parts"].items()) names.push_back(what);
  for (const auto& [name, what] : record["parts"].items()) names.push_back(name);
  names.insert(names.end(), {"Li et al. 2020", "i7-8700"});
  const std::regex number(
      "(\\d[\\d,]*(?:\\.\\d+)?)(?:\u00a0| "
      ")?(µs|ms|kHz|mm|%|triangles|times|cores|s\\b|bytes|planes|"
      "steps|rows|motions|groups|of|and|on|\\.|)");
  std::size_t found = 0;
  for (std::string text : sentences()) {
    if (text.starts_with("Rows that differ")) continue;  // counted below
    for (const std::string& name : names) {
      for (std::size_t i; (i = text.find(name)) != std::string::npos;) text.erase(i, name.size());
    }
    for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it, ++found) {
      std::string digits = (*it)[1];
      if (digits.ends_with(',')) digits.pop_back();
      EXPECT_TRUE(figures.hold((*it)[2], digits)) << it->str() << " in: " << text;
    }
  }
  EXPECT_GT(found, 100u);
}

TEST_F(MeasuredReport, SetsOurPairAgainstThePeersUnderTheSameConditions) {
  const std::size_t most = std::max(largest()["bunny"], largest()["cube.stl"]);
  const json common = {{"triangles", most}, {"activation", "paper"}, {"radius", 5.0}};
  json ours = common, peers = common;
  ours.update({{"index", "wide_bvh"}, {"solver", "active_set"}});
  peers.update({{"index", "fcl_obbrss"}, {"solver", "nlopt_slsqp"}});
  const std::vector<json> us = rows_of(ours), them = rows_of(peers);
  if (them.empty()) GTEST_SKIP() << "needs FCL and NLopt";
  ASSERT_EQ(us.size(), 1u);
  const double quick = us[0]["step_us"]["p50"], slow = them[0]["step_us"]["p50"];
  ASSERT_LT(quick, slow);
  const std::string expected = "wide_bvh with active_set answers a step in " + time_text(quick) +
                               ", where fcl_obbrss with nlopt_slsqp takes " + time_text(slow) +
                               ": " + ratio_text(slow / quick) + " times as long.";
  EXPECT_EQ(record["headline"], expected);
  EXPECT_NE(outcome.output.find(expected), std::string::npos);
  EXPECT_NE(outcome.output.find(record["account"].get<std::string>()), std::string::npos);
  for (const IndexBackend& index : app::indices()) {
    if (index.name != "wide_bvh") continue;
    EXPECT_NE(record["account"].get<std::string>().find("wide_bvh stands for \u201c" +
                                                        std::string(index.description) + "\u201d"),
              std::string::npos);
  }
}

TEST_F(MeasuredReport, NamesTheFastestAndTheSlowestQueryOfEachMesh) {
  for (const auto& [mesh, triangles] : largest()) {
    std::vector<json> rows = rows_of({{"mesh", mesh},
                                      {"triangles", triangles},
                                      {"activation", "paper"},
                                      {"solver", "active_set"},
                                      {"radius", 5.0}});
    std::ranges::stable_sort(rows, {},
                             [](const json& row) { return row["query_us"]["p50"].get<double>(); });
    const json &quick = rows.front(), &slow = rows.back();
    EXPECT_TRUE(is_said("On " + mesh + " with " + grouped(triangles) +
                        " triangles, with a motion sphere of 5" + no_break + "mm, " +
                        quick["index"].get<std::string>() + " finds the triangles in " +
                        time_of(quick, "query_us") + " and " + slow["index"].get<std::string>() +
                        " in " + time_of(slow, "query_us")))
        << mesh;
  }
}

TEST_F(MeasuredReport, StatesTheRateOfEveryRuleOnEveryMesh) {
  for (const auto& [mesh, triangles] : largest()) {
    for (const char* rule : {"paper", "all_faces", "certified"}) {
      json wanted = {{"mesh", mesh},
                     {"triangles", triangles},
                     {"activation", rule},
                     {"index", "wide_bvh"},
                     {"solver", "active_set"}};
      const bool has_radius = std::string(rule) != "certified";
      if (has_radius) wanted["radius"] = 5.0;
      const std::vector<json> rows = rows_of(wanted);
      ASSERT_EQ(rows.size(), 1u);
      const double khz = 1e3 / rows[0]["step_us"]["p50"].get<double>();
      ASSERT_GT(khz, 1.0);
      EXPECT_TRUE(is_said("wide_bvh, " + std::string(rule) + ", active_set" +
                          (has_radius ? ", r = 5" + no_break + "mm" : "") + ": " + rounded(khz) +
                          no_break + "kHz at " + grouped(triangles) + " triangles; 1" + no_break +
                          "kHz is kept up to there"))
          << mesh << ", " << rule;
    }
  }
}

TEST_F(MeasuredReport, NamesWhatIsBuiltFastestAndSlowestAndTheCoresItKeptBusy) {
  for (const auto& [mesh, triangles] : largest()) {
    std::vector<json> rows = rows_of({{"mesh", mesh}, {"triangles", triangles}});
    std::ranges::stable_sort(rows, {},
                             [](const json& row) { return row["build_s"].get<double>(); });
    const auto built = [](const json& row) {
      return "in " + rounded(row["build_s"]) + " s with " + rounded(row["build_cores"], 2) +
             " cores busy";
    };
    EXPECT_TRUE(is_said("On " + mesh + " with " + grouped(triangles) + " triangles, " +
                        rows.front()["index"].get<std::string>() + " is built fastest, " +
                        built(rows.front()) + ", and " + rows.back()["index"].get<std::string>() +
                        " slowest, " + built(rows.back())))
        << mesh;
  }
}

TEST_F(MeasuredReport, ComparesSolversByWhatThePlotShowsOfAsManyPlanes) {
  std::set<std::string> rows;  // as they are told
  for (const json& row : record["rows"]) {
    rows.insert(row["solver"].get<std::string>() + " finds the motion in " +
                time_of(row, "solve_us") + " among " + mean_text(row["planes_mean"]) +
                " planes in the mean");
  }
  const std::regex words("(\\w+ finds the motion in [^ ]+ among ([\\d.]+) planes in the mean)");
  std::size_t told = 0;
  for (const std::string& text : findings("solvers")) {
    std::vector<double> planes;
    for (std::sregex_iterator it(text.begin(), text.end(), words), end; it != end; ++it, ++told) {
      EXPECT_TRUE(rows.contains((*it)[1])) << it->str();
      planes.push_back(std::stod((*it)[2]));
    }
    if (planes.size() == 2) {
      EXPECT_NEAR(planes[0], planes[1], 0.11 * planes[0]) << text;
    }
  }
  EXPECT_GE(told, largest().size()) << outcome.output.substr(0, 2000);
}

TEST_F(MeasuredReport, CountsTheRowsThatAgreeAndThoseLeftOut) {
  std::map<std::string, std::vector<json>> groups;
  for (const json& row : record["rows"]) {
    ASSERT_TRUE(row["verified"]) << row;
    groups[json{row["mesh"], row["triangles"], row["radius"], row["activation"], row["solver"]}
               .dump()]
        .push_back(row);
  }
  for (const auto& [problem, rows] : groups) {
    for (const json& row : rows) EXPECT_EQ(row["hash"], rows[0]["hash"]) << problem;
  }
  const std::string count = grouped(groups.size());
  EXPECT_TRUE(is_said(grouped(record["rows"].size()) + " in " + count +
                      " groups, made the same steps in " + count + " of them"))
      << outcome.output.substr(0, 2000);
}

TEST_F(MeasuredReport, IsTheSameInTheTableAsInTheRecord) {
  std::ifstream csv(folder->file("b.csv"));
  const auto cells = [](const std::string& line) {
    std::vector<std::string> all;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) all.push_back(cell);
    return all;
  };
  std::string line;
  std::getline(csv, line);
  const std::vector<std::string> columns = cells(line);
  std::size_t lines = 0;
  for (; std::getline(csv, line); ++lines) {
    const std::vector<std::string> values = cells(line);
    const json& row = record["rows"][lines];
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::string column = columns[c];
      json told;
      if (const std::size_t at = column.find("_us_"); at != std::string::npos) {
        const json& timing = row[column.substr(0, at + 3)];
        told = timing.is_null() ? json() : timing[column.substr(at + 4)];
      } else if (row.contains(column) && row[column].is_number()) {
        told = row[column];
      } else {
        continue;
      }
      EXPECT_EQ(values[c], told.is_null() ? "" : values[c]) << column;
      if (!told.is_null()) {
        EXPECT_EQ(std::stod(values[c]), told.get<double>()) << column;
      }
    }
  }
  EXPECT_EQ(lines, record["rows"].size());
}

}  // namespace
}  // namespace keepout::test
