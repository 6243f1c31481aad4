// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "campaign.h"
#include "verify/robot/campaign.h"

namespace keepout::app {

/// The result of a campaign. Its record (docs/records.md) is of the kind verify, for a tip, or
/// verify_robot.
struct CampaignResult {
  Json record;
  std::string table;            // of the rows, with what its columns mean, for a terminal
  bool is_broken = false;       // something that is promised did not hold
  bool is_interrupted = false;  // before all of it was done

  /// The table, and what the record says in words.
  void print(std::ostream& out) const;
};

/// The conditions of a campaign with a tip.
struct CampaignRun {
  CampaignSettings settings;
  std::string command;                    // that does it again
  std::string index;                      // that the engine searched with
  std::vector<std::string> missing = {};  // meshes that could not be had
  double seconds = 0.0;                   // wall time, loading included
};

inline constexpr int campaign_format =
    3;  // raised if the trajectories of a seed, or tallies, change

/// Adds up rows, figure by figure: of "least" figures the smallest counts, of "deepest" ones and of
/// triangles the largest. The first row may be null.
void add(Json& sum, const Json& row);
Json total_of(const Json& rows);

/// The counts by the names of what they count.
template <class Enum, std::size_t n>
Json json_of(const std::array<std::uint64_t, n>& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < n; ++i) json[std::string(name(static_cast<Enum>(i)))] = counts[i];
  return json;
}

/// Writes into a record of some shards what its meshes have come to, in numbers and in words.
CampaignResult finished(Json record);

/// The result of one shard.
CampaignResult result_of(const CampaignRun& run, const Findings& findings);

/// Adds up records of one campaign, as a record that `command` makes. Throws Error, naming files,
/// when one is not such a record, or its numbers do not agree with each other, when they are of
/// different campaigns or versions, or share a shard.
CampaignResult merged(const std::vector<std::filesystem::path>& files, const std::string& command);

/// The result of a campaign with an instrument, on so many meshes.
CampaignResult result_of(const RobotCampaign& campaign, const std::string& command,
                         const std::string& index, const std::vector<RobotTally>& tallies,
                         std::size_t meshes);

}  // namespace keepout::app
