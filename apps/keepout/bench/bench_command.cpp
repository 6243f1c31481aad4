// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.h"
#include "bench/parts.h"
#include "command_line.h"
#include "keepout/activation/registry.h"
#include "names.h"

namespace keepout::app {

namespace {

/// To be called last: it has no use for most of the others.
void add_speed_options(CLI::App& command, BenchOptions& options) {
  SpeedOptions& speed_options = options.speed;
  CLI::Option* speed = command.add_flag(
      "--speed", options.is_speed,
      "Measure the table of ratios that keepout is held to, in one process on one core; some "
      "minutes. With --triangles: one size, for meshes of about a million");
  for (const char* name : {"--list", "--index", "--activation", "--solver", "--mesh", "--radius",
                           "--full", "--queries", "--seconds", "--poses", "--csv"}) {
    speed->excludes(name);
  }
  command
      .add_option("--steps", speed_options.histogram_steps, "Of --speed: steps of the histogram")
      ->type_name("NUMBER")
      ->transform(large_count())
      ->needs(speed)
      ->capture_default_str();
  command
      .add_option(
          "--largest", speed_options.largest,
          "Of --speed: also a mesh of so many triangles. 100000000 need 14 GiB, 5 GB of the "
          "disk, and some minutes")
      ->type_name("NUMBER")
      ->transform(whole_number(1000, 200'000'000))
      ->needs(speed);
  command
      .add_flag_callback(
          "--quick",
          [&speed_options] {
            speed_options.effort = quick;
            speed_options.file = "bunny";
          },
          "Of --speed: few of everything, to see that it works")
      ->needs(speed);
}

}  // namespace

void add_bench(CLI::App& app, BenchOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "bench",
      "Time every stage of the step, for indices, rules and solvers side by side; each is held to "
      "brute force and to our own solver as it is timed");
  command.add_flag("--list", options.list, "Say what there is to measure, and stop");
  const auto add_list = [&](const char* name, std::vector<std::string>& list, const auto& table,
                            const char* text) {
    command.add_option(name, list, text)
        ->delimiter(',')
        ->type_name("NAMES")
        ->check(one_of(names(table)));
  };
  add_list("--index", options.selection.indices, indices(), "Indices to measure");
  add_list("--activation", options.selection.activations, activation_rules(), "Rules to measure");
  add_list("--solver", options.selection.solvers, solver_backends(), "Solvers to measure");
  command.add_option("--mesh", options.meshes, "Fixtures, or mesh files")
      ->delimiter(',')
      ->type_name("NAMES");
  command
      .add_option("--triangles", options.triangles,
                  "Sizes to which the bunny is resampled, 150 mm large as in the paper")
      ->delimiter(',')
      ->type_name("NUMBERS")
      ->transform(whole_number(1000, 200'000'000));
  command
      .add_option("--radius", options.selection.radii,
                  "Radii of the motion sphere, in mm; certified looks as far as the motion leads, "
                  "whatever the radius")
      ->delimiter(',')
      ->type_name("MM")
      ->check(length(Zero::refused));
  command.add_flag_callback(
      "--full", [&options] { options.extent = Extent::full; },
      "To 18 million triangles, and the skull of a million: tens of minutes, and 14 GB");
  command.add_option("--queries", options.queries, "Steps of each combination, at most")
      ->type_name("NUMBER")
      ->transform(whole_number(5, 10'000'000));
  command
      .add_option(
          "--seconds", options.seconds,
          "How long a combination is asked, at most, in each of two rounds: stage by stage, "
          "and as a whole")
      ->type_name("S")
      ->check(length(Zero::refused));
  command
      .add_option("--poses", options.poses,
                  "contact: a tool that slides along the surface; unrelated: as a planner asks")
      ->transform(one_of<Poses>({{"contact", Poses::contact}, {"unrelated", Poses::unrelated}}))
      ->default_str("contact");
  add_number(command, "--seed", options.seed, 0, largest_seed, "Seed of the motions");
  command.add_option("--json", options.json, "Where to write all figures")->type_name("FILE");
  command.add_option("--csv", options.csv, "Where to write them as a table")->type_name("FILE");
  command.add_option("--out", options.report, "Where to write a report with plots")
      ->type_name("REPORT.html")
      ->capture_default_str();
  add_speed_options(command, options);
  command.footer(
      "Each list is crossed with the others; what is not named is wide_bvh, paper and certified,\n"
      "active_set, and radii of 5, 1 and 0.25. Without --index, --activation and\n"
      "--solver: each index, then each solver, with those; and FCL's tree with SLSQP.");
}

}  // namespace keepout::app
