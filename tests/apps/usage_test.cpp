// SPDX-License-Identifier: BSD-3-Clause
// What the command says to a mistyped command line, and what it ends with.

#include "apps/command_process.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

using Outcome = test::ProcessOutcome;

TEST(Suggestion, NamesWhatWasLikelyMeant) {
  const std::vector<std::string> names{"wide_bvh", "pd_tree", "brute_force", "bvh"};
  EXPECT_EQ(did_you_mean("wide_bhv", names), "; did you mean 'wide_bvh'?");
  EXPECT_EQ(did_you_mean("PD-Tree", names), "; did you mean 'pd_tree'?");
  EXPECT_EQ(did_you_mean("octree", names), "");
  EXPECT_EQ(did_you_mean(std::string(10'000, 'x'), names), "");
}

struct Mistake {
  std::string arguments;
  std::string told;
};

/// All of them are told on stderr, end with 2, and name the help that helps.
void expect_told(const std::vector<Mistake>& mistakes) {
  const test::CommandFolder folder;
  for (const auto& [arguments, told] : mistakes) {
    const Outcome outcome = folder.run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << '\n' << outcome.output;
    EXPECT_TRUE(outcome.output.starts_with("keepout: " + told)) << arguments << '\n'
                                                                << outcome.output;
    EXPECT_CONTAINS(outcome.output, "--help'.\n");
    EXPECT_EQ(folder.run(arguments + " 2>/dev/null | cat").output, "") << arguments;
  }
}

TEST(Usage, EachCommandMistypedIsSuggested) {
  std::vector<Mistake> mistakes;
  for (const auto& [typed, meant] : std::array<std::array<std::string, 2>, 10>{{
           {"inspec", "inspect"},
           {"regsiter", "register"},
           {"relpay", "replay"},
           {"simulat", "simulate"},
           {"liev", "live"},
           {"server", "serve"},
           {"verfiy", "verify"},
           {"bnech", "bench"},
           {"compair", "compare"},
           {"plann", "plan"},
       }}) {
    mistakes.push_back(
        {typed + " cube", "there is no command '" + typed + "'; did you mean '" + meant + "'?"});
  }
  mistakes.push_back({"", "a command is missing; there are inspect, "});
  mistakes.push_back({"cube.stl", "there is no command 'cube.stl'; there are inspect, "});
  expect_told(mistakes);
}

TEST(Usage, AnOptionOfEachCommandMistypedIsSuggested) {
  const auto told = [](const std::string& typed, const std::string& meant) {
    return "there is no option " + typed + "; did you mean '" + meant + "'?";
  };
  expect_told({
      {"inspect cube --jsno", told("--jsno", "--json")},
      {"register f.csv --taget 1 2 3", told("--taget", "--target")},
      {"replay cube --pose p --out s.csv", told("--pose", "--poses")},
      {"simulate cube --raduis 1", told("--raduis", "--radius")},
      {"simulate cube --raduis=1", told("--raduis", "--radius")},
      {"live cube --no-opne", told("--no-opne", "--no-open")},
      {"serve cube --joint 3", told("--joint", "--joints")},
      {"verify cube --step 10", told("--step", "--steps")},
      {"bench --spead", told("--spead", "--speed")},
      {"compare --pair 3", told("--pair", "--pairs")},
      {"plan --planer RRT", told("--planer", "--planner")},
      {"--versoin", told("--versoin", "--version")},
      {"inspect cube --colour", "there is no option --colour\n"},
  });
}

TEST(Usage, NamesAndValuesAreToldWithTheirOption) {
  expect_told({
      {"simulate cube --index wide_bhv",
       "--index: there is no 'wide_bhv'; did you mean 'wide_bvh'? There are: "},
      {"simulate cube --solver activeset", "--solver: there is no 'activeset'; did you mean"},
      {"simulate cube --activation certifed,paper", "--activation: there is no 'certifed'; did"},
      {"simulate cube --query spere", "--query: there is no 'spere'; did you mean 'sphere'?"},
      {"replay cube --poses p --out s --activation best",
       "--activation: there is no 'best'; there are: all_faces, paper, certified\n"},
      {"inspect cube --space lsp", "--space: there is no 'lsp'; did you mean 'lps'?"},
      {"bench --index embre", "--index: there is no 'embre'; did you mean 'embree'?"},
      {"bench --poses kontact", "--poses: there is no 'kontact'; did you mean 'contact'?"},
      {"bench --seconds soon", "--seconds: expected a number above 0 and at most 1e30, not 'soon'"},
      {"bench --radius abc", "--radius: expected a number above 0 and at most 1e30, not 'abc'"},
      {"register f.csv --target 1 2", "--target: a value is missing"},
      {"register f.csv --measured-in cm", "--measured-in: there is no 'cm'"},
      {"plan --planner RTT", "--planner: there is no 'RTT'; did you mean 'RRT'?"},
      {"plan --seconds soon",
       "--seconds: expected seconds above 0 and not above 86400, not 'soon'"},
      {"verify cube --shard 3", "--shard: expected I/N, part I of N"},
      {"--simd AVX22 inspect cube", "--simd: there is no 'AVX22'; "},
      {"bench --simd SCALAR", "--simd goes before the command: 'keepout --simd ... bench'"},
      {"simulate cube --radius abc", "--radius: expected a number from 1e-15 to 1e15, not 'abc'"},
      {"simulate cube --radius", "--radius: a value is missing"},
      {"inspect cube --json=many", "--json: "},
  });
}

TEST(Usage, WhatIsMissingOrDoesNotGoTogetherIsNamed) {
  expect_told({
      {"simulate", "an argument is missing: MESH is required"},
      {"replay cube --out s.csv", "an argument is missing: --poses is required"},
      {"inspect cube gear", "'gear' is one argument too many for inspect"},
      {"replay cube --poses p --out s --max-step 1",
       "--max-step has a meaning only together with --closed-loop"},
      {"verify --merge a.json --steps 3", "--steps and --merge cannot be given together"},
  });
}

TEST(Usage, TheExitStatusSaysWhatKindOfEndItWas) {
  const test::CommandFolder folder;
  EXPECT_EQ(folder.run("inspect cube").status, 0);
  EXPECT_EQ(folder.run("--help").status, 0);
  EXPECT_EQ(folder.run("inspect no_such_mesh").status, 1);
  EXPECT_EQ(folder.run("inspect").status, 2);  // 130: verify_command_test.cpp
  for (const char* status : {"0 if all went well", "1 if something failed",
                             "2 if the command line is wrong", "130 if it was interrupted"}) {
    EXPECT_CONTAINS(folder.run("--help").output, status) << status;
  }
}

TEST(Usage, HelpCallsTheCommandWhatTheUserHasCalledIt) {
  const test::CommandFolder folder;
  const Outcome direct = folder.run("inspec");
  EXPECT_CONTAINS(direct.output, "See 'keepout --help'.");
  const Outcome by_run =
      folder.run("simulate cub --raduis 1", R"(bash -c 'exec -a ./run "$0" "$@"' )");
  EXPECT_CONTAINS(by_run.output, "See './run simulate --help'.");
  // What only ./run does is told by it alone.
  const std::string help_of_run =
      folder.run("--help", R"(bash -c 'exec -a ./run "$0" "$@"' )").output;
  EXPECT_CONTAINS(help_of_run, "./run experiments");
  EXPECT_LACKS(folder.run("--help").output, "experiments");
}

}  // namespace
}  // namespace keepout::app
