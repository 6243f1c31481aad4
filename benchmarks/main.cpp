// SPDX-License-Identifier: BSD-3-Clause
// keepout-bench: all commands of keepout, and also bench, compare and plan. keepout starts this
// program for these three, and for simulate --bench.
#include <span>

#include "bench/bench.h"
#include "compare/compare.h"
#include "plan/plan.h"
#include "user_commands.h"

int main(int argc, char** argv) {
  using namespace keepout::app;
  std::vector<Command> commands = user_commands(time_parts);
  commands.push_back(command("bench", add_bench, bench));
  commands.push_back(command("compare", add_compare, compare));
  commands.push_back(command("plan", add_plan, plan));
  for (Command& added : std::span(commands).last(3)) {
    added.group = "Commands of the package keepout-bench";
  }
  return run_program(commands, argc, argv);
}
