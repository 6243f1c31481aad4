// SPDX-License-Identifier: BSD-3-Clause
#include "verify/verify.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#include "shared/stop_signal.h"
#include "verify/result.h"

namespace keepout::app {
namespace {

/// Returns the meshes that the user names, or those for the named robot. Without either, returns
/// small hostile meshes, drawn anew, for instruments, and all sample meshes for tips. Appends an
/// error text for each missing sample mesh to `missing`.
std::vector<Arena> arenas_of(const VerifyOptions& options, std::vector<std::string>& missing) {
  const Campaign& campaign = options;
  std::vector<std::filesystem::path> named = options.meshes;
  if (named.empty() && !campaign.robot.empty()) named = {"skull", "airway", "brain", "femur"};
  std::vector<Arena> arenas;
  for (const std::filesystem::path& mesh : named) {
    file_of_mesh(mesh);  // throws before any work if the mesh does not exist
    if (std::ranges::find(arenas, mesh.string(), &Arena::mesh) != arenas.end()) {
      throw Error(mesh.string() + ": is named twice");
    }
    arenas.push_back(named_arena(mesh.string(), campaign.index));
  }
  if (!arenas.empty()) return arenas;
  if (campaign.is_of_instruments()) return hostile_arenas(campaign.index);
  arenas = generated_arenas(campaign.index);
  for (Arena& arena : real_arenas(campaign.index, missing)) arenas.push_back(std::move(arena));
  return arenas;
}

CampaignResult run(const VerifyOptions& options, std::ostream& out) {
  const Campaign& campaign = options;
  std::vector<std::string> missing;
  std::vector<Arena> arenas = arenas_of(options, missing);
  const bool is_of_tips = !campaign.is_of_instruments();
  const bool is_drawn = campaign.robot.empty() || !arenas.front().load;
  const std::uint64_t length = is_of_tips ? steps_of_a_trajectory
                               : is_drawn ? cycles_of_a_drawn_trajectory
                                          : cycles_of_a_trajectory;
  const std::uint64_t trajectories =
      trajectory_count(is_of_tips ? campaign.steps : campaign.cycles, length);
  if (campaign.shard.count > trajectories) {
    const std::string steps = is_of_tips ? "steps" : "cycles";
    throw Error("--shard: there are only " + std::to_string(trajectories) + " trajectories of " +
                std::to_string(length) + " " + steps + " to distribute; use fewer shards or more " +
                steps);
  }
  for (const std::string& mesh : missing) out << "note: " << mesh << '\n';
  const StopSignal stop(keeps_what_is_finished, BeforeWork::ends_process);
  for (Arena& arena : arenas) {
    if (!arena.load) continue;
    arena.load = [load = std::move(arena.load), &stop] {
      return unless_stopped(stop, load).value_or(std::vector<Scene>{});
    };
  }
  Progress progress("verify", campaign.length(arenas.size()));
  Findings findings =
      run_campaign(campaign, arenas,
                   [&, shown = std::string()](std::uint64_t steps, const std::string& row) mutable {
                     stop.keep_from_now_on();
                     progress.advance(steps);
                     if (row != shown) progress.show(shown = row);
                     return stop.has_come() ? Next::stop : Next::go_on;
                   });
  findings.missing = std::move(missing);
  return result_of(campaign, findings);
}

/// Returns the files, and instead of each folder the records in it.
std::vector<std::filesystem::path> records_in(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    if (files.size() == before) throw Error(path.string() + ": the folder has no record");
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  return files;
}

/// Returns the shard that "I/N" describes.
Shard shard_of(const std::string& text) {
  std::istringstream in(text);
  Shard shard{0, 0};
  char slash = ' ';
  in >> shard.index >> slash >> shard.count;
  const bool is_read = in && in.peek() == std::istringstream::traits_type::eof() && slash == '/';
  if (!is_read || shard.index < 1 || shard.index > shard.count || shard.count > Shard::most) {
    throw CLI::ValidationError("--shard",
                               "expected I/N, part I of N, such as 1/2 or 2/2, of at most " +
                                   std::to_string(Shard::most) + "; not '" + text + "'");
  }
  return shard;
}

}  // namespace

void add_verify(CLI::App& app, VerifyOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "verify",
      "Try to break the certified step: adversarial closed-loop motion over many meshes, each step "
      "judged by an independent, exact oracle");
  command.add_option("MESH", options.meshes,
                     "Mesh files in mm, or sample meshes; default: all sample meshes");
  Campaign& campaign = options;
  CLI::Option* named =
      add_robot(command, campaign.robot, campaign.bodies, names(robots_under_test()),
                "Attack a whole instrument, in joint space");
  CLI::Option* chosen =
      command.add_option("--scenario", campaign.scenarios, "Kinds of attack, also in joint space")
          ->check(one_of(names(app::scenarios())))
          ->delimiter(',');
  const std::array of_joints{
      command.add_option("--cycles", campaign.cycles, "Cycles for each mesh, scenario and speed")
          ->type_name("NUMBER")
          ->transform(whole_number(1, most_steps))
          ->capture_default_str(),
      command
          .add_option("--speed", campaign.speeds,
                      "Speeds, in multiples of 0.5 mm and 0.02 rad a cycle")
          ->check(number_within(1e-3, 1e3, "a multiple from 0.001 to 1000", "NUMBER"))
          ->delimiter(',')
          ->capture_default_str(),
      command
          .add_option("--rate", campaign.rate,
                      "Rate of the cycles in Hz; default: as the joints' velocity limits admit the "
                      "speed")
          ->check(number_within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz", "NUMBER")),
      command.add_option("--motion", campaign.motion, "The motion that is certified")
          ->transform(one_of<CertifiedMotion>(certified_motion_names))
          ->default_str("actual"),
      add_length(command, "--margin", campaign.margin, Zero::refused,
                 "Clearance of bodies beyond their radius")};
  command.final_callback([named, chosen, of_joints] {
    for (const CLI::Option* option : of_joints) {
      if (option->empty() || !named->empty() || !chosen->empty()) continue;
      throw CLI::RequiresError(option->get_name(), "--robot or --scenario");
    }
  });
  command.add_option("--steps", campaign.steps, "Steps of the whole campaign")
      ->type_name("NUMBER")
      ->transform(whole_number(1, most_steps))
      ->capture_default_str()
      ->excludes(named)
      ->excludes(chosen);
  add_number(command, "--seed", campaign.seed, 0, largest_seed,
             "Seed: the same seed and steps give the same campaign");
  command
      .add_option_function<std::string>(
          "--shard", [&](const std::string& text) { campaign.shard = shard_of(text); },
          "Run part I of N of the campaign")
      ->type_name("I/N")
      ->default_str("1/1");
  add_plugins(command);
  add_part(command, "--index", campaign.index, index_names(), index_backends,
           "Index that finds triangles");
  const std::vector<CLI::Option*> of_a_run = command.get_options([&](const CLI::Option* option) {
    return option != command.get_help_ptr() && option != command.get_help_all_ptr();
  });
  options.files.add_to(command);
  CLI::Option* merge =
      command
          .add_option("--merge", options.merge,
                      "Add up the results of a campaign's shards: records, or folders of records")
          ->type_name("FILES");
  for (CLI::Option* option : of_a_run) merge->excludes(option);
  command.footer(
      "Ctrl-C ends the campaign early: the finished part is printed and written.\nThe exit status "
      "is 0 only if steps were tested and none broke a guarantee of docs/certified-step.md, and "
      "with --robot\nor "
      "--scenario a guarantee of docs/joint-space-step.md or docs/guides.md. With --motion "
      "linearized\nthere is no guarantee.\n\n--scenario without --robot draws a chain and bodies "
      "anew for each start, and without MESH\na mesh of up to 400 triangles: soup, fan, sheets, "
      "cone, bowl, saddle. 'stuck', 'tip_guides'\nand 'convex_tool' have their own robot.\n\n" +
      listing("Scenarios", scenarios()) + "\n" + listing("Robots", robots_under_test()));
}

int verify(const VerifyOptions& options, std::ostream& out) {
  std::vector<NamedPath> inputs;
  for (const auto& mesh : options.meshes) inputs.push_back({"MESH", file_of_mesh(mesh)});
  const std::vector<std::filesystem::path> merge = records_in(options.merge);
  for (const auto& file : merge) inputs.push_back({"--merge", file});
  for (const NamedPath& file : robot_inputs(options.robot, options.bodies)) inputs.push_back(file);
  OutputFiles outputs(inputs,
                      {{"--out", options.files.page}, {"--json", options.files.kept_json()}});
  const CampaignResult result = merge.empty() ? run(options, out) : merged(merge, options.command);
  result.print(out);  // before writing: a full disk must not hide the verdict
  write_record(outputs, result.record, options.files);
  if (result.is_broken) return EXIT_FAILURE;
  if (!merge.empty()) {
    if (result.record.at("complete").get<bool>()) return EXIT_SUCCESS;
    std::cerr << "keepout: the campaign is incomplete: --merge needs the finished record of every "
                 "shard\n";
    return EXIT_FAILURE;
  }
  if (result.is_interrupted) return exit_interrupted;
  const Json& total = result.record.at("total");
  const bool is_of_tips = total.contains("steps");
  if (total.at(is_of_tips ? "steps" : "cycles") != 0) return EXIT_SUCCESS;
  std::cerr << "keepout: nothing was tested: no start was found; is the mesh in mm, and is the "
               "margin smaller than the mesh?\n";
  return EXIT_FAILURE;
}

}  // namespace keepout::app
