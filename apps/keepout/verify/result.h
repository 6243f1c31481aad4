// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "campaign.h"

namespace keepout::app {

// The result of a campaign, or of some of its shards, is a record (docs/records.md): it is written,
// read, added up and printed as what it is.

/// What was run, beside what came out.
struct CampaignRun {
  CampaignSettings settings;
  std::string command;                    // that does it again
  std::string index;                      // that the engine searched with
  std::vector<std::string> missing = {};  // meshes that could not be had
  double seconds = 0.0;                   // wall time, loading included
};

/// The result of one shard.
Json result_of(const CampaignRun& run, const Findings& findings);

/// Adds up results of one campaign. Throws Error, naming files, when one is not such a result, or
/// its numbers do not agree with each other, when they are of different campaigns or versions, or
/// share a shard.
Json merged(const std::vector<std::filesystem::path>& files);

/// How many steps broke the theorem.
std::uint64_t breach_count(const Json& result);

/// Whether all shards are there, none of them interrupted.
bool is_complete(const Json& result);

/// How many steps broke the theorem, of how many, in a sentence.
std::string headline(const Json& result);

/// What is not there, and why: sentences.
std::vector<std::string> account(const Json& result);

/// The result as a table, the first breaches, and what machine it was.
void print(std::ostream& out, const Json& result);

}  // namespace keepout::app
