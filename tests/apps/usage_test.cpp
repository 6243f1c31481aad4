// SPDX-License-Identifier: BSD-3-Clause
// What the command ends with, and what it is called; mistyped command lines: test_bad_input.py.

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
