// SPDX-License-Identifier: BSD-3-Clause
#include "verify.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "../command_line.h"
#include "../machine.h"
#include "../named_mesh.h"
#include "../names.h"
#include "../output_file.h"
#include "../progress.h"
#include "../stop_signal.h"
#include "campaign.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "result.h"

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
  of_a_run.push_back(command.add_option("--steps", options.steps, "Steps of the whole campaign")
                         ->type_name("NUMBER")
                         ->transform(large_count())
                         ->capture_default_str());
  of_a_run.push_back(add_number(command, "--seed", options.seed, 0, largest_seed,
                                "Seed: same seed and steps, same campaign"));
  of_a_run.push_back(command.add_option("--shard", options.shard, "Do part I of N of the campaign")
                         ->type_name("I/N")
                         ->check(check_shard)
                         ->capture_default_str());
  of_a_run.push_back(add_name(command, "--index", options.index, names(index_backends()),
                              "Index that finds triangles"));
  options.files.add_to(command);
  CLI::Option* merge =
      command.add_option("--merge", options.merge, "Add up the results of a campaign's shards")
          ->type_name("FILES");
  for (CLI::Option* option : of_a_run) merge->excludes(option);
  command.footer(
      "Ctrl-C ends it early: what is finished is printed and written.\n"
      "The exit status is 0 only if no step broke what docs/certified-step.md promises.");
}

int verify(const VerifyOptions& options, std::ostream& out) {
  std::vector<NamedPath> inputs;
  for (const auto& mesh : options.meshes) inputs.push_back({"MESH", file_of_mesh(mesh)});
  for (const auto& file : options.merge) inputs.push_back({"--merge", file});
  OutputFiles outputs(inputs,
                      {{"--json", options.files.kept_json()}, {"--out", options.files.page}});
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
