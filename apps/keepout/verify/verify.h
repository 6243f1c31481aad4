// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "record/record.h"
#include "verify/campaign.h"
#include "verify/robot/campaign.h"

namespace CLI {
class App;
}

namespace keepout::app {

struct VerifyOptions {
  std::vector<std::filesystem::path> meshes;  // none: all fixtures
  std::uint64_t steps = 1'000'000;
  std::uint64_t seed = 1;
  Shard shard;
  std::string index = "wide_bvh";
  RecordFiles files;
  std::vector<std::filesystem::path> merge;  // records to add up, instead of a campaign
  RobotCampaign robot;                       // instead, where it names a robot or scenarios
  std::string command;                       // that does it again
};

/// Adds `keepout verify` and its options to the command line.
void add_verify(CLI::App& app, VerifyOptions& options);

/// Tries by all means to break what docs/certified-step.md promises, or docs/joint-space-step.md
/// where a robot is named, or adds up earlier tries, and prints a table. A StopSignal ends it
/// early, and what is done is printed and written. The exit status: failure when there was any
/// breach. Throws Error.
int verify(const VerifyOptions& options, std::ostream& out);

}  // namespace keepout::app
