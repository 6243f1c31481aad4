// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verify.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <ostream>

#include "../machine.h"
#include "../named_mesh.h"
#include "../output_file.h"
#include "../progress.h"
#include "../stop_signal.h"
#include "arenas.h"
#include "campaign.h"
#include "keepout/error.h"
#include "keepout/simd_target.h"
#include "keepout/version.h"
#include "result.h"

namespace keepout::app {
namespace {

/// "I/N"; nothing where it is not that.
std::optional<Shard> parse_shard(const std::string& text) {
  Shard shard{0, 0};
  const char* const last = text.data() + text.size();
  const auto index = std::from_chars(text.data(), last, shard.index);
  const bool has_slash = index.ec == std::errc{} && index.ptr != last && *index.ptr == '/';
  const auto count =
      has_slash ? std::from_chars(index.ptr + 1, last, shard.count) : std::from_chars_result{};
  const bool is_read = has_slash && count.ec == std::errc{} && count.ptr == last;
  if (!is_read || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

std::uint64_t trajectory_count_of(const Shard& shard, std::uint64_t all) {
  return (all + shard.count - shard.index) / shard.count;
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

CampaignResult run(const VerifyOptions& options, std::ostream& out) {
  const Shard shard = parse_shard(options.shard).value();
  if (shard.count > trajectory_count(options.steps)) {
    throw Error("--shard: there are only " + std::to_string(trajectory_count(options.steps)) +
                " trajectories of " + std::to_string(steps_of_a_trajectory) +
                " steps to share out; ask for fewer shards or more steps");
  }
  CampaignResult result{.version = KEEPOUT_VERSION,
                        .seed = options.seed,
                        .steps = options.steps,
                        .index = options.index,
                        .shard_count = shard.count};
  const std::vector<Arena> arenas = arenas_of(options, result.missing);
  for (const std::string& mesh : result.missing) out << "note: " << mesh << '\n';
  const auto start = std::chrono::steady_clock::now();
  const StopSignal stop;
  {
    Progress progress("verify", options.steps / shard.count);
    result.findings = run_campaign({.seed = options.seed, .steps = options.steps, .shard = shard},
                                   arenas, [&](std::uint64_t steps) {
                                     progress.advance(steps);
                                     return stop.has_come() ? Next::stop : Next::go_on;
                                   });
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // A signal that came after the last trajectory has interrupted nothing.
  const bool is_whole = result.findings.total().trajectories ==
                        trajectory_count_of(shard, trajectory_count(options.steps));
  result.shards = {{shard.index, seconds,
                    processor() + ", " + std::string(simd_target()) + ", " + KEEPOUT_COMPILER +
                        ", " + KEEPOUT_BUILD_TYPE,
                    is_whole}};
  return result;
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
  // Before any work: what cannot be written shall not be told of after an hour.
  std::unique_ptr<OutputFile> json;
  if (options.json) {
    std::vector<NamedPath> inputs;
    for (const auto& mesh : options.meshes) inputs.push_back({"MESH", file_of_mesh(mesh)});
    for (const auto& file : options.merge) inputs.push_back({"--merge", file});
    const NamedPath output{"--json", *options.json};
    refuse_shared_files(inputs, {&output, 1});
    json = std::make_unique<OutputFile>(*options.json);
  }
  const CampaignResult result = options.merge.empty() ? run(options, out) : merged(options.merge);
  if (json) {
    write_json(json->stream(), result);
    json->commit();
  }
  print(out, result);
  if (result.findings.total().breach_count() > 0) return EXIT_FAILURE;
  const bool interrupted = options.merge.empty() && !result.shards.front().is_whole;
  return interrupted ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
