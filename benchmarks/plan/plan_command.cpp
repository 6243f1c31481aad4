// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <limits>

#include "keepout/error.h"
#include "plan/plan.h"
#include "shared/command_line.h"
#include "shared/names.h"
#include "verify/robot/start.h"

namespace keepout::app {

void add_plan(CLI::App& app, PlanOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "plan",
      "Plan through real anatomy with OMPL, with sampled and with certified checking side by "
      "side; an independent, exact oracle judges every path");
  CLI::Option* mesh =
      command
          .add_option(
              "MESH", options.meshes,
              "Mesh file in mm, or a sample mesh; default: airway (within) and skull (around)")
          ->expected(1);
  CLI::Option* robot =
      add_robot(command, options.robot, options.bodies, names(robots_under_test()),
                "Plan for a whole instrument, in joint space, always around the meshes");
  command.add_flag("--inside", options.inside, "Plan within MESH, not around it")
      ->needs(mesh)
      ->excludes(robot);
  add_number(command, "--seeds", options.seeds, 1, 10'000,
             "Runs of each problem under each checker, each with its own seed")
      ->needs(robot);
  add_number(command, "--problems", options.problems, 1, 10'000,
             "Number of problems for each mesh");
  add_number(command, "--seed", options.seed, 0, largest_seed, "Seed of problems and planners");
  add_name(command, "--planner", options.planner, ompl_planners,
           "Planner of OMPL, for all checkers");
  command.add_option("--seconds", options.seconds, "Time limit of the planner for each problem")
      ->check(number_within(std::numeric_limits<double>::denorm_min(), 86400.0,
                            "seconds above 0 and not above 86400", "SECONDS"))
      ->capture_default_str();
  command
      .add_option("--resolution", options.resolutions,
                  "Spacing of sampled checking, as fractions of the extent; OMPL's default is 0.01")
      ->delimiter(',')
      ->check(number_within(1e-6, 1.0, "a fraction of the extent from 0.000001 to 1", "SHARE"))
      ->capture_default_str();
  add_length(command, "--tool-radius", options.tool_radius, Zero::allowed,
             "Radius of the ball around the tip")
      ->excludes(robot);
  add_length(command, "--margin", options.margin, Zero::refused,
             "Required distance between tool and surface");
  add_length(
      command, "--radius", options.radius, Zero::refused,
      "Radius of the motion sphere: certified checking splits motions into pieces of this length")
      ->excludes(robot);
  add_length(command, "--range", options.range, Zero::allowed,
             "Longest motion that a planner adds, 0.01 at least; 0: a fifth of the extent, as OMPL "
             "has it")
      ->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            // RRTConnect asks for the time only after one tree has grown all the way to the other.
            const double range = std::strtod(text.c_str(), nullptr);
            if (range == 0.0 || range >= 0.01) return {};
            return "expected 0 or a number from 0.01 to 1e30, not '" + text + "'";
          },
          ""));
  command.add_flag("--simplify", options.simplify,
                   "Shorten each path with OMPL's simplifier, under the same checker");
  options.files.add_to(command);
  command.add_option("--csv", options.files.csv, "Where to write a line for every run")
      ->type_name("FILE");
  command.footer(
      "Ctrl-C ends it early: finished runs are judged, printed and written.\n"
      "The exit status is 0 only if a path was found, and no path that keepout accepted is "
      "invalid.\n"
      "docs/planning.md explains the choice of problems and the columns.\n\n" +
      listing("Robots", robots_under_test()));
}

#ifndef KEEPOUT_HAS_OMPL
int plan(const PlanOptions&, std::ostream&) {
  throw Error(
      "plan: keepout was built without OMPL. Install libompl-dev, then configure and build again "
      "with -DKEEPOUT_WITH_OMPL=ON and no sanitizers");
}
#endif

}  // namespace keepout::app
