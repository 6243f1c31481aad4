// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compare_command.h"

#include "named_mesh.h"
#include "command_line.h"
#include "names.h"

namespace keepout::app {

CompareCommand::CompareCommand(CLI::App& app) {
  CompareOptions& options = options_;
  CLI::App& command = *app.add_subcommand(
      "compare",
      "Hold all parts that can take each other's place to each other and to the truth, on the same "
      "input: indices, solvers, narrow phases");
  command.add_option("MESH", options.mesh, std::string(mesh_help))->capture_default_str();
  command.add_option("--poses", options.extent.poses, "Poses for the indices, under each rule")
      ->type_name("NUMBER")
      ->transform(whole_number(6, 1'000'000))
      ->capture_default_str();
  command.add_option("--problems", options.extent.problems, "Recorded problems for the solvers")
      ->type_name("NUMBER")
      ->transform(whole_number(10, 1'000'000))
      ->capture_default_str();
  command
      .add_option("--pairs", options.extent.pairs,
                  "Pairs of tool and triangle for the narrow phases, of each kind: apart, "
                  "overlapping, and touching, which is within " +
                      std::string(touch_text) + " of a touch, on either side")
      ->type_name("NUMBER")
      ->transform(whole_number(10, 1'000'000))
      ->capture_default_str();
  command.add_option("--seed", options.extent.seed, "Seed of poses, problems and pairs")
      ->type_name("NUMBER")
      ->transform(whole_number(0, largest_seed))
      ->capture_default_str();
  command.add_option("--json", options.json, "Where to write the tables and the verdict")
      ->type_name("FILE");
  command.footer(
      "The exit status is 0 only if all indices agree to the bit and no solver is wrong; 130 "
      "after\n"
      "Ctrl-C, which keeps the rows that are finished.");
}

int CompareCommand::run(const std::vector<std::string>& arguments, std::ostream& out) {
  options_.command = "keepout";
  for (const std::string& argument : arguments) options_.command += " " + shell_word(argument);
  return compare(options_, out);
}

}  // namespace keepout::app
