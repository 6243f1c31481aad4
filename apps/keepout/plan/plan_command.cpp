// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/plan_command.h"

#include "name_checks.h"
#include "number_checks.h"

namespace keepout::app {
namespace {

/// A share of the extent to check motions at; CLI11's own range check lets 'nan' pass.
CLI::Validator resolution() {
  return {[](std::string& text) {
            double value = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && value >= 1e-6 && value <= 1.0) return std::string();
            return "expected a share of the extent from 0.000001 to 1, not '" + text + "'";
          },
          "SHARE"};
}

CLI::Validator seconds() {
  return {[](std::string& text) {
            double value = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && value > 0.0 && value <= 86400.0) return std::string();
            return "expected seconds above 0 and not above 86400, not '" + text + "'";
          },
          "SECONDS"};
}

}  // namespace

PlanCommand::PlanCommand(CLI::App& app) {
  PlanOptions& options = options_;
  CLI::App& command = *app.add_subcommand(
      "plan",
      "Plan through real anatomy with OMPL, under sampled and under certified checking side by "
      "side, and have an independent, exact oracle judge every path");
  CLI::Option* mesh = command.add_option(
      "MESH", options.mesh,
      "Mesh file in mm, or a fixture; without one, airway (within) and skull (around)");
  command.add_flag("--inside", options.inside, "Plan within MESH, not around it")->needs(mesh);
  command.add_option("--problems", options.problems, "Problems of each mesh")
      ->type_name("NUMBER")
      ->transform(whole_number(1, 10'000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of problems and planners")
      ->type_name("NUMBER")
      ->transform(whole_number(0, largest_seed))
      ->capture_default_str();
  command.add_option("--planner", options.planner, "Planner of OMPL, the same under each checker")
      ->check(one_of(ompl_planners))
      ->capture_default_str();
  command.add_option("--seconds", options.seconds, "Time that a planner has for each problem")
      ->check(seconds())
      ->capture_default_str();
  command
      .add_option(
          "--resolution", options.resolutions,
          "How finely sampled checking samples, in shares of the extent; OMPL's own is 0.01")
      ->delimiter(',')
      ->check(resolution())
      ->capture_default_str();
  command.add_option("--tool-radius", options.tool_radius, "Radius of the ball around the tip")
      ->type_name("MM")
      ->check(length(Zero::allowed))
      ->capture_default_str();
  command.add_option("--margin", options.margin, "Distance to keep between tool and surface")
      ->type_name("MM")
      ->check(length(Zero::refused))
      ->capture_default_str();
  command
      .add_option(
          "--radius", options.radius,
          "Radius of the motion sphere: certified checking cuts motions into pieces so long")
      ->type_name("MM")
      ->check(length(Zero::refused))
      ->capture_default_str();
  command
      .add_option("--range", options.range,
                  "Longest motion that a planner adds; 0: a fifth of the extent, as OMPL has it")
      ->type_name("MM")
      ->check(length(Zero::allowed))
      ->capture_default_str();
  command.add_flag("--simplify", options.simplify,
                   "Shorten each path by OMPL's simplifier, under the same checker");
  command.add_option("--json", options.json, "Where to write every run, its path included")
      ->type_name("FILE");
  command.add_option("--csv", options.csv, "Where to write a line for every run")
      ->type_name("FILE");
  command.add_option("--out", options.page, "Where to write a page with pictures of the paths")
      ->type_name("FILE.html");
  command.footer(
      "Ctrl-C ends it early: what is finished is judged, printed and written.\n"
      "The exit status is 0 only if no path that keepout let pass is invalid.\n"
      "How problems are chosen, and what the columns say: docs/planning.md.");
}

}  // namespace keepout::app
