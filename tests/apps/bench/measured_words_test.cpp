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
#include "keepout/adapters/all_indices.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/solvers/registry.h"
#include "shared/number_text.h"

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
class MeasuredWords : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<CommandFolder>();
    write_binary_stl(folder->file("cube.stl"), make_cube(20.0));
    std::string indices = "wide_bvh,pd_tree", solvers = "active_set";
    for (const IndexBackend& index : all_index_backends()) {
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

  static std::vector<std::string> sentences() {
    return {record["headline"], record["account"], record["same_steps"]};
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
    for (const json& row : rows) add_row(row);
    for (const json& row : rows) {
      for (const json& other : rows) {
        if (row["mesh"] == other["mesh"]) add_ratio(row, other);
      }
    }
  }

  bool hold(const std::string& unit, const std::string& number) const {
    const auto known = of_unit_.find(unit);
    return known != of_unit_.end() && known->second.contains(number);
  }

 private:
  void add(const std::string& unit, std::size_t count) { of_unit_[unit].insert(grouped(count)); }

  void add_row(const json& row) {
    for (const std::string unit : {"triangles", "and", "on"}) {
      add(unit, row["triangles"].get<std::size_t>());
    }
    for (const std::string unit : {"steps", "motions"}) {
      add(unit, row["queries"].get<std::size_t>());
    }
    if (!row["radius"].is_null()) of_unit_["mm"].insert(app::trimmed(row["radius"]));
    if (row["step_us"].is_null()) return;
    const std::string text = time_text(row["step_us"]["p50"]);
    const std::size_t space = text.find(no_break);
    of_unit_[text.substr(space + no_break.size())].insert(text.substr(0, space));
  }

  void add_ratio(const json& row, const json& other) {
    if (row["step_us"].is_null() || other["step_us"].is_null()) return;
    of_unit_["times"].insert(
        ratio_text(row["step_us"]["p50"].get<double>() / other["step_us"]["p50"].get<double>()));
  }

  std::map<std::string, std::set<std::string>> of_unit_;
};

TEST_F(MeasuredWords, EachNumberInASentenceIsOneOfTheRecord) {
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
  EXPECT_GT(found, 10u);
}

TEST_F(MeasuredWords, SetsOurPairAgainstThePeersUnderTheSameConditions) {
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
  for (const IndexBackend& index : all_index_backends()) {
    if (index.name != "wide_bvh") continue;
    EXPECT_NE(record["account"].get<std::string>().find("wide_bvh stands for \u201c" +
                                                        std::string(index.description) + "\u201d"),
              std::string::npos);
  }
}

TEST_F(MeasuredWords, CountsTheRowsThatAgreeAndThoseLeftOut) {
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

TEST_F(MeasuredWords, IsTheSameInTheTableAsInTheRecord) {
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
