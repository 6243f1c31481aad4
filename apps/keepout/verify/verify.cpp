// SPDX-License-Identifier: BSD-3-Clause
#include "verify.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <sstream>

#include "../named_mesh.h"
#include "../output_file.h"
#include "../progress.h"
#include "../stop_signal.h"
#include "campaign.h"
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
  if (!is_read || shard.index < 1 || shard.index > shard.count) return std::nullopt;
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

}  // namespace

CLI::Validator shard_text() {
  const auto check = [](std::string& text) {
    return parse_shard(text) ? std::string()
                             : "expected I/N, part I of N, such as 1/2 or 2/2; not '" + text + "'";
  };
  return {check, ""};
}

int verify(const VerifyOptions& options, std::ostream& out) {
  std::vector<NamedPath> inputs;
  for (const auto& mesh : options.meshes) inputs.push_back({"MESH", file_of_mesh(mesh)});
  for (const auto& file : options.merge) inputs.push_back({"--merge", file});
  OutputFiles outputs(inputs, {{"--json", options.json}});
  const Json result = options.merge.empty() ? run(options, out) : merged(options.merge);
  if (auto* const json = outputs.stream("--json")) {
    *json << result.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
  }
  outputs.commit();
  print(out, result);
  if (breach_count(result) > 0) return EXIT_FAILURE;
  const bool interrupted = options.merge.empty() && !result["shards"][0]["complete"].get<bool>();
  return interrupted ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
