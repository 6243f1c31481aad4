// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tally.h"

namespace keepout::app {

/// One run of a part of a campaign: which, where and how long.
struct ShardRun {
  std::uint64_t index = 1;
  double seconds = 0.0;  // wall time, loading included
  std::string machine;
  bool is_whole = true;  // false: it was interrupted
};

/// A campaign, as far as its shards are done.
struct CampaignResult {
  std::string version;  // of keepout
  std::uint64_t seed = 1;
  std::uint64_t steps = 0;  // of all shards
  std::string index;        // that the engine searched with
  std::uint64_t shard_count = 1;
  std::vector<ShardRun> shards = {};      // done, in their order
  std::vector<std::string> missing = {};  // meshes that could not be had
  Findings findings = {};
};

void write_json(std::ostream& out, const CampaignResult& result);

/// Throws Error, naming the file, when it is not what write_json wrote.
CampaignResult read_json(const std::filesystem::path& path);

/// Adds up results of one campaign. Throws Error, naming files, when they are of different
/// campaigns or versions, or share a shard.
CampaignResult merged(const std::vector<std::filesystem::path>& files);

/// Which shards are not there.
std::vector<std::uint64_t> missing_shards(const CampaignResult& result);

/// Whether all shards are there, none of them interrupted.
bool is_complete(const CampaignResult& result);

/// The results as a table, the first breaches, and what machine it was.
void print(std::ostream& out, const CampaignResult& result);

}  // namespace keepout::app
