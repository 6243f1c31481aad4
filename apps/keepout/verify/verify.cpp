// SPDX-License-Identifier: BSD-3-Clause
#include "verify.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "campaign.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "result.h"
#include "shared/command_line.h"
#include "shared/machine.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "verify/robot/hostile_mesh.h"
#include "verify/robot/result.h"

namespace keepout::app {
namespace {

/// "I/N"; nothing where it is not that.
std::optional<Shard> parse_shard(const std::string& text) {
  std::istringstream in(text);
  Shard shard{0, 0};
  char slash = ' ';
  in >> shard.index >> slash >> shard.count;
  const bool is_read = in && in.peek() == std::istringstream::traits_type::eof() && slash == '/';
  if (!is_read || shard.index < 1 || shard.index > shard.count || shard.count > Shard::most) {
    return std::nullopt;
  }
  return shard;
}

std::vector<Arena> arenas_of(const VerifyOptions& options, std::vector<std::string>& missing) {
  std::vector<Arena> arenas;
  for (const std::filesystem::path& mesh : options.meshes) {
    file_of_mesh(mesh);  // before any work: is there such a one?
    const auto is_same = [&](const Arena& arena) { return arena.mesh == mesh.string(); };
    if (std::any_of(arenas.begin(), arenas.end(), is_same)) {
      throw Error(mesh.string() + ": is named twice");
    }
    arenas.push_back(named_arena(mesh.string(), options.index));
  }
  if (!arenas.empty()) return arenas;
  arenas = generated_arenas(options.index);
  for (Arena& arena : real_arenas(options.index, missing)) arenas.push_back(std::move(arena));
  return arenas;
}

Json run(const VerifyOptions& options, std::ostream& out) {
  const Shard shard = parse_shard(options.shard).value();
  if (shard.count > trajectory_count(options.steps)) {
    throw Error("--shard: there are only " + std::to_string(trajectory_count(options.steps)) +
                " trajectories of " + std::to_string(steps_of_a_trajectory) +
                " steps to share out; ask for fewer shards or more steps");
  }
  CampaignRun run{.settings = {.seed = options.seed, .steps = options.steps, .shard = shard},
                  .command = options.command,
                  .index = options.index};
  const std::vector<Arena> arenas = arenas_of(options, run.missing);
  for (const std::string& mesh : run.missing) out << "note: " << mesh << '\n';
  const auto start = std::chrono::steady_clock::now();
  const StopSignal stop;
  Progress progress("verify", options.steps / shard.count);
  const Findings findings = run_campaign(run.settings, arenas, [&](std::uint64_t steps) {
    progress.advance(steps);
    return stop.has_come() ? Next::stop : Next::go_on;
  });
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result_of(run, findings);
}

/// The meshes that are named. Without a name, for a robot that is named the largest real ones and a
/// small one, else small hostile ones that are drawn.
std::vector<Arena> arenas_for_robot(const VerifyOptions& options) {
  VerifyOptions on = options;
  if (on.meshes.empty()) {
    if (options.robot.robot.empty()) return hostile_arenas(options.index);
    on.meshes = {"skull", "airway", "brain", "femur"};
  }
  std::vector<std::string> missing;
  return arenas_of(on, missing);
}

Json run_with_robot(const VerifyOptions& options) {
  RobotCampaign campaign = options.robot;
  campaign.seed = options.seed;
  const std::vector<Arena> arenas = arenas_for_robot(options);
  const StopSignal stop;
  Progress progress("verify", cycle_count(campaign, arenas.size()));
  const auto advanced = [&](const RobotTally& row, std::uint64_t cycles) {
    progress.advance(cycles);
    progress.show(row.mesh + ", " + row.scenario);
    return stop.has_come() ? Next::stop : Next::go_on;
  };
  const std::vector<RobotTally> tallies = run_robot_campaign(campaign, arenas, advanced);
  return result_of(campaign, options.command, options.index, tallies, arenas.size());
}

int verify_with_robot(const VerifyOptions& options, OutputFiles& outputs, std::ostream& out) {
  const Json record = run_with_robot(options);
  write_record(outputs, record, options.files, std::cerr);
  print_robot_result(out, record);
  const bool must_hold = options.robot.motion == CertifiedMotion::actual;
  if (must_hold && robot_breaches(record) > 0) return EXIT_FAILURE;
  return record["complete"].get<bool>() ? EXIT_SUCCESS : exit_interrupted;
}

/// Options of a campaign in joint space: with --robot, or --scenario.
void add_robot(CLI::App& command, RobotCampaign& robot, std::vector<CLI::Option*>& of_a_run) {
  std::vector<CLI::Option*> of_joints;  // of no use without one of the two
  CLI::Option* named =
      command.add_option("--robot", robot.robot, "Try it with a whole instrument, in joint space")
          ->check(one_of(names(robots_under_test())));
  CLI::Option* chosen =
      command.add_option("--scenario", robot.scenarios, "Kinds of attack, in joint space as well")
          ->check(one_of(names(app::scenarios())))
          ->delimiter(',');
  of_a_run.insert(of_a_run.end(), {named, chosen});
  const auto add = [&](CLI::Option* option) {
    of_a_run.push_back(option);
    of_joints.push_back(option);
  };
  add(command.add_option("--cycles", robot.cycles, "Cycles for each mesh, scenario and speed")
          ->type_name("NUMBER")
          ->transform(large_count())
          ->capture_default_str());
  add(command
          .add_option("--speed", robot.speeds,
                      "How fast, in multiples of 0.5 mm and 0.02 rad a cycle")
          ->check(number_within(1e-3, 1e3, "a multiple from 0.001 to 1000", "NUMBER"))
          ->delimiter(',')
          ->capture_default_str());
  add(command.add_option("--motion", robot.motion, "Which motion is certified")
          ->transform(one_of<CertifiedMotion>(certified_motion_names))
          ->default_str("actual"));
  add(add_length(command, "--margin", robot.margin, Zero::refused,
                 "Distance that bodies keep beyond their radius"));
  command.final_callback([named, chosen, of_joints] {
    for (const CLI::Option* option : of_joints) {
      if (option->empty() || !named->empty() || !chosen->empty()) continue;
      throw CLI::RequiresError(option->get_name(), "--robot or --scenario");
    }
  });
}

/// What --shard may be told; nothing is wrong with it when the text is empty.
std::string check_shard(const std::string& text) {
  if (parse_shard(text)) return {};
  return "expected I/N, part I of N, such as 1/2 or 2/2, of at most " +
         std::to_string(Shard::most) + "; not '" + text + "'";
}

}  // namespace

void add_verify(CLI::App& app, VerifyOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "verify",
      "Try to break the certified step: adversarial closed-loop motion over many meshes, each step "
      "judged by an independent, exact oracle");
  std::vector<CLI::Option*> of_a_run;
  of_a_run.push_back(command.add_option(
      "MESH", options.meshes, "Mesh files in mm, or fixtures; without one, all fixtures"));
  add_robot(command, options.robot, of_a_run);
  CLI::Option* const robot = command.get_option("--robot");
  CLI::Option* const scenario = command.get_option("--scenario");
  of_a_run.push_back(command.add_option("--steps", options.steps, "Steps of the whole campaign")
                         ->type_name("NUMBER")
                         ->transform(large_count())
                         ->capture_default_str()
                         ->excludes(robot)
                         ->excludes(scenario));
  of_a_run.push_back(add_number(command, "--seed", options.seed, 0, largest_seed,
                                "Seed: same seed and steps, same campaign"));
  of_a_run.push_back(command.add_option("--shard", options.shard, "Do part I of N of the campaign")
                         ->type_name("I/N")
                         ->check(check_shard)
                         ->capture_default_str()
                         ->excludes(robot)
                         ->excludes(scenario));
  of_a_run.push_back(add_name(command, "--index", options.index, names(index_backends()),
                              "Index that finds triangles"));
  options.files.add_to(command);
  CLI::Option* merge =
      command.add_option("--merge", options.merge, "Add up the results of a campaign's shards")
          ->type_name("FILES");
  for (CLI::Option* option : of_a_run) merge->excludes(option);
  command.footer(
      "Ctrl-C ends it early: what is finished is printed and written.\n"
      "The exit status is 0 only if no step broke what docs/certified-step.md promises, and with\n"
      "--robot or --scenario docs/joint-space-step.md and docs/guides.md; but with --motion\n"
      "linearised nothing is promised.\n\n"
      "--scenario without --robot draws a chain and bodies anew for each start, and without MESH\n"
      "a mesh of up to 400 triangles: soup, fan, sheets, cone, bowl, saddle. 'stuck', "
      "'tip_guides'\n"
      "and 'convex_tool' have a robot of their own.\n\n" +
      listing("Scenarios", scenarios()) + "\n" + listing("Robots", robots_under_test()));
}

int verify(const VerifyOptions& options, std::ostream& out) {
  std::vector<NamedPath> inputs;
  for (const auto& mesh : options.meshes) inputs.push_back({"MESH", file_of_mesh(mesh)});
  for (const auto& file : options.merge) inputs.push_back({"--merge", file});
  OutputFiles outputs(inputs,
                      {{"--json", options.files.kept_json()}, {"--out", options.files.page}});
  if (!options.robot.robot.empty() || !options.robot.scenarios.empty()) {
    return verify_with_robot(options, outputs, out);
  }
  Json result = options.merge.empty() ? run(options, out) : merged(options.merge);
  if (!options.merge.empty()) {  // not what one of the shards was made by
    result["command"] = options.command;
    result["date"] = date_now();
  }
  write_record(outputs, result, options.files, std::cerr);
  print(out, result);
  if (breach_count(result) > 0) return EXIT_FAILURE;
  const bool interrupted = options.merge.empty() && !result["shards"][0]["complete"].get<bool>();
  return interrupted ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
