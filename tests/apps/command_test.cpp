// SPDX-License-Identifier: BSD-3-Clause
// The keepout command as a process: its output and its files.

#include <cstdlib>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "apps/command_process.h"
#include "factory/tools_by_name.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/simd_target.h"

namespace keepout {
namespace {

using Outcome = test::ProcessOutcome;
using Row = std::map<std::string, std::string>;

/// Prints the table of simulate without the times, which are the columns kHz, p50 and p99.
constexpr const char* untimed_rows =
    " | grep -E '^(rule|none|all_faces|paper|certified) ' | awk '{$3=$4=$5=\"\"; print}'";

class Command : public testing::Test {
 protected:
  void SetUp() override { write_binary_stl(file("cube.stl"), make_cube(10.0)); }

  std::filesystem::path file(const std::string& name) const { return folder_.file(name); }
  Outcome run(const std::string& arguments) const { return folder_.run(arguments); }

  /// Returns the rows of a CSV file, by column name.
  std::vector<Row> rows(const std::string& name) const {
    std::ifstream stream(file(name));
    const auto cells = [](const std::string& line) {
      std::vector<std::string> all;
      std::istringstream rest(line);
      for (std::string cell; std::getline(rest, cell, ',');) all.push_back(cell);
      return all;
    };
    std::string line;
    std::getline(stream, line);
    const std::vector<std::string> header = cells(line);
    std::vector<Row> table;
    while (std::getline(stream, line)) {
      const std::vector<std::string> values = cells(line);
      Row row;
      for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = values.at(i);
      table.push_back(row);
    }
    return table;
  }

  static Vec3 vector(const Row& row, const std::string& prefix) {
    return {std::stod(row.at(prefix + "x")), std::stod(row.at(prefix + "y")),
            std::stod(row.at(prefix + "z"))};
  }

  test::CommandFolder folder_;
};

TEST_F(Command, SaysThatNothingOfABenchmarkWasFinishedWhenItIsInterruptedAtOnce) {
  write_binary_stl(file("ball.stl"), make_sphere(0.5));
  const Outcome outcome =
      folder_.interrupted({KEEPOUT_COMMAND, "simulate", "ball.stl", "--bench", "--verbose",
                           "--strokes", "1", "--cycles", "10", "--out", "r.html"},
                          "SIMD target");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "stopped before any row of the benchmark was finished");
  EXPECT_LACKS(outcome.output, "Timed as well");
  EXPECT_TRUE(std::filesystem::exists(file("r.html")));
}

TEST_F(Command, HelpNamesEveryCommandAndChoice) {
  const Outcome help = succeeded(run("--help"));
  for (const char* word : {"inspect", "register", "replay", "simulate"}) {
    EXPECT_CONTAINS(help.output, word) << word;
  }
  const Outcome replay = succeeded(run("replay --help"));
  for (const char* word : {"brute_force", "pd_tree", "all_faces", "paper", "active_set",
                           "--closed-loop", "--radius", "--margin", "--planes", "--max-step"}) {
    EXPECT_CONTAINS(replay.output, word) << word;
  }
}

TEST_F(Command, ReplaySolvesOneStepForEachLine) {
  folder_.write("poses.txt", "0 0 60 1 2 -3\n3 4 51 1 -2 -3\n3 4 51 0 0 -6\n");
  succeeded(run("replay cube.stl --poses poses.txt --out steps.csv --planes planes.csv"));
  const std::vector<Row> steps = rows("steps.csv");
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0].at("status"), "free");
  EXPECT_EQ(vector(steps[0], "u"), Vec3(1, 2, -3));
  EXPECT_EQ(steps[1].at("status"), "limited");
  EXPECT_LT((vector(steps[1], "u") - Vec3(1, -2, -0.8)).norm(), 1e-12);  // with a margin of 0.2
  EXPECT_EQ(vector(steps[1], "p"), Vec3(3, 4, 51));
  EXPECT_EQ(steps[2].at("status"), "beyond_reach");
  EXPECT_EQ(vector(steps[2], "u"), Vec3(0, 0, 0));

  const std::vector<double> distances{10.0, 1.0, 1.0};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_NEAR(std::stod(steps[i].at("distance")), distances[i], 1e-12);
  }

  std::size_t of_step_1 = 0;
  for (const Row& plane : rows("planes.csv")) {
    const std::size_t step = std::stoul(plane.at("step"));
    of_step_1 += step == 1;
    const double slack =
        vector(plane, "n").dot(vector(steps[step], "u")) - std::stod(plane.at("offset"));
    EXPECT_GE(slack, -1e-12);
  }
  EXPECT_EQ(of_step_1, std::stoul(steps[1].at("planes")));
  EXPECT_GT(of_step_1, 0u);
}

TEST_F(Command, TheHeadersAreThoseAgreedUpon) {
  folder_.write("poses.txt", "0 0 60 1 2 -3\n");
  ASSERT_EQ(run("replay cube.stl --poses poses.txt --out s.csv --planes p.csv").status, 0);
  std::string line;
  std::ifstream steps(file("s.csv"));
  std::getline(steps, line);
  EXPECT_EQ(line,
            "step,status,px,py,pz,dx,dy,dz,ux,uy,uz,triangles,planes,"
            "t_query_ns,t_activate_ns,t_solve_ns,t_total_ns,distance");
  std::ifstream planes(file("p.csv"));
  std::getline(planes, line);
  EXPECT_EQ(line, "step,triangle,nx,ny,nz,offset");
}

TEST_F(Command, TheAnatomicalSpaceIsAskedForAndGiven) {
  folder_.write("poses.txt", "0 0 60 1 2 -3\n");
  const std::string replay = "replay cube.stl --poses poses.txt --out s.csv --space RAS";
  const Outcome refused = run(replay);
  EXPECT_NE(refused.status, 0);
  EXPECT_CONTAINS(refused.output, "--untagged");
  EXPECT_EQ(run(replay + " --untagged lps").status, 0);
  EXPECT_NE(run(replay + " --untagged xyz").status, 0);
  const Outcome inspected = run("inspect cube.stl --untagged lps");
  EXPECT_CONTAINS(inspected.output, "LPS, not stated in the file");
}

TEST_F(Command, AMeshIsScaledAndFlippedOnDemandAndStderrSaysSo) {
  folder_.write("poses.txt", "0 0 60000 1 2 -3\n");
  const std::string replay = "replay cube.stl --poses poses.txt --out s.csv ";
  const Outcome scaled = run(replay + "--unit m --flip");
  EXPECT_EQ(scaled.status, 0);
  EXPECT_CONTAINS(scaled.output, "keepout: cube.stl: scaled by 1000, from m to mm");
  EXPECT_CONTAINS(scaled.output,
                  "keepout: cube.stl: flipped: each triangle is wound the other way");
  EXPECT_CONTAINS(scaled.output, "mm across after it was scaled by 1000");
  EXPECT_CONTAINS(run(replay + "--scale 2").output, "cube.stl: scaled by 2");
  EXPECT_CONTAINS(run("inspect cube.stl --flip").output, "flipped, as asked");
}

TEST_F(Command, EveryNumberReadsBackExactly) {
  folder_.write("poses.txt", "0.1 0.2 60.3 0.30000000000000004 1e-17 -0.7\n");
  ASSERT_EQ(run("replay cube.stl --poses poses.txt --out s.csv").status, 0);
  const Row step = rows("s.csv").at(0);
  EXPECT_EQ(vector(step, "p"), Vec3(0.1, 0.2, 60.3));
  EXPECT_EQ(vector(step, "u"), Vec3(0.30000000000000004, 1e-17, -0.7));
}

TEST_F(Command, AClosedLoopFollowsItsGoalsUpToTheSurface) {
  std::string poses;
  for (int i = 0; i < 60; ++i) poses += "3 4 40 3 4 60\n";
  folder_.write("poses.txt", poses);
  ASSERT_EQ(run("replay cube.stl --poses poses.txt --out s.csv --closed-loop --max-step 0.5 "
                "--radius 1 --margin 0.25")
                .status,
            0);
  const std::vector<Row> steps = rows("s.csv");
  ASSERT_EQ(steps.size(), 60u);
  Vec3 tip(3, 4, 60);
  for (const Row& step : steps) {
    ASSERT_LT((vector(step, "p") - tip).norm(), 1e-12);
    ASSERT_LE(vector(step, "d").norm(), 0.5 + 1e-12);
    tip += vector(step, "u");
  }
  EXPECT_LT((tip - Vec3(3, 4, 50.25)).norm(), 1e-9);
}

TEST_F(Command, APartWhoseModuleIsAbsentOrBrokenSaysWhatToDo) {
  folder_.write("poses.txt", "0 0 60 1 2 -3\n");
  folder_.write("bullet.so", "no shared object");
  const auto with = [&](const std::string& part) {
    return folder_.run("replay cube.stl --poses poses.txt --out s.csv " + part,
                       "KEEPOUT_MODULES=.");
  };
  for (const char* part : {"--index fcl_obbrss", "--solver nlopt_mma"}) {
    const Outcome refused = with(part);
    EXPECT_NE(refused.status, 0) << part;
    EXPECT_CONTAINS(refused.output, "install keepout-modules") << part;
  }
  const Outcome broken = with("--index bullet");
  EXPECT_NE(broken.status, 0);
  EXPECT_CONTAINS(broken.output, "bullet.so cannot be loaded");
  EXPECT_EQ(with("--index wide_bvh").status, 0) << "what needs no module";
}

TEST_F(Command, EveryIndexAndRuleCanBeChosen) {
  folder_.write("poses.txt", "3 4 51 1 -2 -3\n");
  for (const char* choice : {"--index brute_force", "--index pd_tree", "--activation all_faces",
                             "--activation paper", "--activation certified", "--solver active_set",
                             "--query sphere", "--refine 0", "--branches 16"}) {
    const Outcome outcome =
        run(std::string("replay cube.stl --poses poses.txt --out s.csv ") + choice);
    ASSERT_EQ(outcome.status, 0) << choice << outcome.output;
    EXPECT_LT((vector(rows("s.csv").at(0), "u") - Vec3(1, -2, -0.8)).norm(), 1e-12) << choice;
  }
}

TEST_F(Command, AToolWithARadiusIsKeptOffByItAndTheMargin) {
  folder_.write("poses.txt", "3 4 51 1 -2 -3\n");
  succeeded(run("replay cube.stl --poses poses.txt --out s.csv --tool-radius 0.5 --margin 0.1"));
  EXPECT_LT((vector(rows("s.csv").at(0), "u") - Vec3(1, -2, -0.4)).norm(), 1e-12);
}

TEST_F(Command, AConvexToolByNameStepsAsPutTogetherByHandBitForBit) {
  const auto phases = narrow_phase_backends();
  std::size_t number = 0;
  for (const auto& [text, tool] : test::tools_by_name()) {
    const std::string phase(phases[number++ % phases.size()].name);  // each of them in turn
    const auto loop = test::loop_by_hand(tool, phase);
    std::ofstream poses(file("poses.txt"));
    for (const auto& [tip, desired, status, motion] : loop) {
      poses << std::setprecision(17) << tip.transpose() << " " << desired.transpose() << "\n";
    }
    poses << std::flush;
    succeeded(run("replay cube.stl --poses poses.txt --out s.csv --tool " + text +
                  " --narrow-phase " + phase));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Row row = rows("s.csv").at(i);
      EXPECT_EQ(row.at("status"), name(loop[i].status));
      EXPECT_EQ(vector(row, "u"), loop[i].motion) << text << " " << phase;
    }
  }
}

TEST_F(Command, ASignalLeavesNoPartialFile) {
  // No process writes into the pipe, so the command waits with partial files.
  const Outcome outcome =
      run("--version; mkfifo poses; '" KEEPOUT_COMMAND
          "' replay cube.stl --poses poses --out s.csv --planes p.csv & "
          "for i in $(seq 1000); do ls p.csv.partial-* >/dev/null 2>&1 && break; sleep 0.01; done; "
          "ls; kill -TERM $!; wait $!; echo \"ended with $?\"");
  EXPECT_CONTAINS(outcome.output, "p.csv.partial-");
  EXPECT_CONTAINS(outcome.output, "ended with 130");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_LACKS(entry.path().string(), "partial") << entry.path();
  }
}

TEST_F(Command, AnUnfitMeshIsNamed) {
  Surface plates = make_thin_plates(10.0);
  for (Corners& corners : plates.triangles) std::swap(corners[0], corners[1]);
  write_binary_stl(file("plates.stl"), plates);
  const Outcome outcome = run("simulate plates.stl --out r.html --strokes 1 --cycles 10");
  EXPECT_EQ(outcome.status, EXIT_FAILURE);
  EXPECT_CONTAINS(outcome.output, "plates.stl: no free place");
}

TEST_F(Command, ARuleThatIsNamedTwiceRunsOnce) {
  const Outcome outcome = succeeded(
      run("simulate cube.stl --out r.html --strokes 1 --cycles 20 --activation paper,paper "
          "--verbose 2>/dev/null"));
  const std::size_t first = outcome.output.find("\npaper ");
  ASSERT_NE(first, std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("\npaper ", first + 1), std::string::npos) << outcome.output;
}

TEST_F(Command, WithoutAFixtureThereAreNoTimes) {
  const Outcome outcome = succeeded(
      run("simulate cube.stl --out r.html --strokes 1 --cycles 20 --activation paper --verbose"));
  std::istringstream row(outcome.output.substr(outcome.output.find("\nnone ")));
  std::string rule, cycles, khz, p50, p99;
  row >> rule >> cycles >> khz >> p50 >> p99;
  EXPECT_EQ(cycles, "20");
  EXPECT_EQ(khz + p50 + p99, "---") << outcome.output;
}

TEST_F(Command, TheRecordTellsTheDateAndTheCommandThatMakesItAgain) {
  const auto untimed = [&](const std::string& arguments) {
    return run(arguments + " --verbose 2>/dev/null" + untimed_rows).output;
  };
  const std::string table = untimed(
      "simulate cube.stl --json r.json --strokes 2 --cycles 50 --margin 0.1 --radius 1.25 "
      "--activation certified --untagged lps --seed 12");
  const nlohmann::json record = nlohmann::json::parse(std::ifstream(file("r.json")));
  EXPECT_TRUE(std::regex_match(record["date"].get<std::string>(),
                               std::regex("20\\d\\d-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\dZ")))
      << record["date"];
  EXPECT_EQ(record["machine"]["simd"], std::string(simd_target()));
  EXPECT_EQ(record["settings"]["seed"], "12");
  const std::string command = record["command"];
  ASSERT_TRUE(command.starts_with("keepout simulate ")) << command;
  for (const char* given : {"--seed 12 ", "--untagged lps "}) {
    EXPECT_CONTAINS(command, given);
  }
  EXPECT_CONTAINS(table, "\nnone ");
  EXPECT_EQ(untimed(command.substr(8)), table);
}

TEST_F(Command, SimulatePrintsATableAndWritesAReport) {
  const Outcome outcome = succeeded(
      run("simulate cube.stl --out r.html --strokes 3 --cycles 200 --radius 1 --verbose"));
  for (const char* word : {"none", "all_faces", "paper", "certified", "r.html"}) {
    EXPECT_CONTAINS(outcome.output, word) << word;
  }
  EXPECT_CONTAINS(folder_.contents("r.html"), "</html>");
}

TEST_F(Command, TheSameSeedMovesTheSameHand) {
  const auto untimed = [&](const std::string& seed) {
    const Outcome outcome =
        run("simulate cube.stl --out r.html --strokes 3 --cycles 200 "
            "--activation certified --verbose --seed " +
            seed + " 2>/dev/null" + untimed_rows);
    return outcome.output;
  };
  const std::string seven = untimed("7");
  EXPECT_EQ(seven, untimed("7"));
  EXPECT_NE(seven, untimed("8"));
}

}  // namespace
}  // namespace keepout
