// SPDX-License-Identifier: BSD-3-Clause
// The exit status of the command, and its name. Mistyped command lines: test_bad_input.py.

#include "apps/command_process.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

using Outcome = test::ProcessOutcome;

/// Runs the command under the name by which ./run calls it.
constexpr const char* as_run = R"(bash -c 'exec -a ./run "$0" "$@"' )";

TEST(Suggestion, NamesWhatWasLikelyMeant) {
  const std::vector<std::string> names{"wide_bvh", "pd_tree", "brute_force", "bvh"};
  EXPECT_EQ(did_you_mean("wide_bhv", names), "; did you mean 'wide_bvh'?");
  EXPECT_EQ(did_you_mean("PD-Tree", names), "; did you mean 'pd_tree'?");
  EXPECT_EQ(did_you_mean("octree", names), "");
  EXPECT_EQ(did_you_mean(std::string(10'000, 'x'), names), "");
}

TEST(Usage, TheExitStatusSaysWhatKindOfEndItWas) {
  const test::CommandFolder folder;
  EXPECT_EQ(folder.run("inspect cube").status, 0);
  EXPECT_EQ(folder.run("--help").status, 0);
  EXPECT_EQ(folder.run("inspect no_such_mesh").status, 1);
  EXPECT_EQ(folder.run("inspect").status, 2);  // 130: verify_command_test.cpp
  for (const char* status : {"0 on success", "1 if something failed",
                             "2 if the command line is wrong", "130 if it was interrupted",
                             "bench, compare, plan, replay, simulate\nand verify then write"}) {
    EXPECT_CONTAINS(folder.run("--help").output, status) << status;
  }
}

TEST(Usage, HelpIsACommandAsWell) {
  const test::CommandFolder folder;
  for (const auto& [one, other] :
       {std::pair("help", "--help"), std::pair("-V", "--version"),
        std::pair("help verify", "verify --help"), std::pair("help bench", "bench --help")}) {
    EXPECT_EQ(succeeded(folder.run(one)).output, folder.run(other).output);
  }
  for (const char* mistyped : {"help verfy", "verfy --help", "verfy -V"}) {
    const Outcome outcome = folder.run(mistyped);
    EXPECT_EQ(outcome.status, 2) << mistyped;
    EXPECT_EQ(
        outcome.output,
        "keepout: there is no command 'verfy'; did you mean 'verify'?\nSee 'keepout --help'.\n");
  }
}

TEST(Usage, CountsMayHaveAnExponent) {
  const test::CommandFolder folder;
  for (const char* arguments :
       {"simulate cube --strokes 1e0 --cycles 2e1 --activation certified --branches 1e1 --seed 1E3",
        "verify cube --steps 1.5e3"}) {
    test::succeeded(folder.run(arguments));
  }
}

TEST(Usage, RunSuggestsItsOwnCommands) {
  const test::CommandFolder folder;
  for (const char* arguments : {"expirements", "expirements --help", "help expirements"}) {
    const Outcome outcome = folder.run(arguments, as_run);
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_CONTAINS(outcome.output, "did you mean 'experiments'?\nSee './run --help'.");
  }
  EXPECT_LACKS(folder.run("expirements").output, "experiments'");
}

TEST(Usage, HelpCallsTheCommandWhatTheUserHasCalledIt) {
  const test::CommandFolder folder;
  EXPECT_CONTAINS(folder.run("inspec").output, "See 'keepout --help'.");
  const Outcome by_run = folder.run("simulate cub --raduis 1", as_run);
  EXPECT_CONTAINS(by_run.output, "See './run simulate --help'.");
  // Only the help of ./run lists what only ./run does.
  EXPECT_CONTAINS(folder.run("--help", as_run).output, "./run experiments");
  EXPECT_LACKS(folder.run("--help").output, "experiments");
}

}  // namespace
}  // namespace keepout::app
