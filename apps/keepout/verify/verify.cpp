// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verify.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <ostream>

#include "../machine.h"
#include "../output_file.h"
#include "../progress.h"
#include "arenas.h"
#include "campaign.h"
#include "keepout/error.h"
#include "keepout/version.h"
#include "result.h"

namespace keepout::app {
namespace {

/// "I/N".
Shard parse_shard(const std::string& text) {
  Shard shard{0, 0};
  const char* const last = text.data() + text.size();
  const auto index = std::from_chars(text.data(), last, shard.index);
  const bool has_slash = index.ec == std::errc{} && index.ptr != last && *index.ptr == '/';
  const auto count =
      has_slash ? std::from_chars(index.ptr + 1, last, shard.count) : std::from_chars_result{};
  const bool is_read = has_slash && count.ec == std::errc{} && count.ptr == last;
  if (!is_read || shard.index < 1 || shard.index > shard.count) {
    throw Error("--shard: expected I/N, part I of N, such as 1/2 or 2/2; not '" + text + "'");
  }
  return shard;
}

std::vector<Arena> arenas_of(const VerifyOptions& options, std::vector<std::string>& missing) {
  std::vector<Arena> arenas;
  for (const std::filesystem::path& mesh : options.meshes) {
    if (!std::filesystem::exists(mesh)) {
      throw Error(mesh.string() + ": cannot be read; is it there?");
    }
    const auto is_same = [&](const Arena& arena) { return arena.mesh == mesh.string(); };
    if (std::any_of(arenas.begin(), arenas.end(), is_same)) {
      throw Error(mesh.string() + ": is named twice");
    }
    arenas.push_back(file_arena(mesh, mesh.string(), options.index));
  }
  if (!arenas.empty()) return arenas;
  arenas = generated_arenas(options.index);
  for (Arena& arena : real_arenas(options.index, missing)) arenas.push_back(std::move(arena));
  return arenas;
}

CampaignResult run(const VerifyOptions& options, std::ostream& out) {
  const Shard shard = parse_shard(options.shard);
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
  {
    Progress progress("verify", options.steps / shard.count);
    result.findings = run_campaign({.seed = options.seed, .steps = options.steps, .shard = shard},
                                   arenas, [&](std::uint64_t steps) { progress.advance(steps); });
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.shards = {
      {shard.index, seconds, processor() + ", " + KEEPOUT_COMPILER + ", " + KEEPOUT_BUILD_TYPE}};
  return result;
}

}  // namespace

int verify(const VerifyOptions& options, std::ostream& out) {
  // Before any work: what cannot be written shall not be told of after an hour.
  std::unique_ptr<OutputFile> json;
  if (options.json) {
    std::vector<NamedPath> inputs;
    for (const auto& mesh : options.meshes) inputs.push_back({"MESH", mesh});
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
  return result.findings.total().breach_count() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace keepout::app
