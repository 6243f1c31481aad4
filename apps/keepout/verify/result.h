// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "verify/campaign.h"

namespace keepout::app {

/// The result of a campaign. Its record (docs/records.md) is of the kind verify, for a tip, or
/// verify_robot.
struct CampaignResult {
  Json record;
  std::string table;            // the rows with a legend, for a terminal
  bool is_broken = false;       // a guarantee did not hold
  bool is_interrupted = false;  // the campaign was stopped early

  /// Prints the table, and the headline and account of the record.
  void print(std::ostream& out) const;
};

/// Increases when the trajectories of a seed, or the tallies, change.
inline constexpr int campaign_format = 4;

/// Adds a row to a sum, number by number. Keeps the smallest of "least" numbers, and the largest of
/// "deepest" numbers and of triangles. `sum` may be null at first.
void add(Json& sum, const Json& row);
Json total_of(const Json& rows);

/// Returns the counts with the names of the enumerators as keys.
template <class Enum>
Json json_of(std::span<const std::uint64_t> counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    json[std::string(name(static_cast<Enum>(i)))] = counts[i];
  }
  return json;
}

/// Returns the sentence that bounds the rate of breaches if no trajectory had one: the upper limit
/// of Clopper and Pearson (1934) at 95 %, one-sided. The unit is the trajectory, because its steps
/// depend on each other. Precondition: `trajectories` > 0.
std::string rate_bound(std::uint64_t trajectories);

/// Writes totals, headline and account into a record of some shards of a campaign with tips.
CampaignResult finished(Json record);
/// Like finished(record), but of a campaign with instruments, and also writes its rows.
CampaignResult finished(Json record, const std::vector<Tally>& rows);

/// Returns the rows of a record of a campaign with instruments. Throws Json::exception if a member
/// is missing or of another type, and Error if a number is not a count.
std::vector<Tally> tallies_of(const Json& record);
/// Adds a row of an instrument to a sum. Each percentile of times becomes the larger one, which is
/// an upper bound of the percentile of all.
void add(Tally& sum, const Tally& row);

/// Writes the members that describe the shard of a campaign.
void write_shard(Json& record, const Campaign& campaign, const Findings& findings);
/// Returns the numbers of the shards that a record lacks.
std::vector<std::uint64_t> missing_shards(const Json& record);
/// Returns true if no shard of a record was stopped early.
bool are_whole(const Json& record);
/// Appends a text for each number.
void note_missing(Json& account, const Json& record);

/// Returns the result of one shard of a campaign.
CampaignResult result_of(const Campaign& campaign, const Findings& findings);
CampaignResult result_of_instruments(const Campaign& campaign, const Findings& findings);

/// Adds up the records of shards of one campaign, into a record that `command` makes. Throws Error
/// with the names of the files if a file is not such a record, or if its numbers contradict each
/// other. Also throws Error if two files are of different campaigns or versions, or have a shard in
/// common.
CampaignResult merged(const std::vector<std::filesystem::path>& files, const std::string& command);

}  // namespace keepout::app
