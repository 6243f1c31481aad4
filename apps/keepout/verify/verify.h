// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "record/record.h"
#include "verify/campaign.h"

namespace CLI {
class App;
}

namespace keepout::app {

struct VerifyOptions : Campaign {
  std::vector<std::filesystem::path> meshes;  // empty: all sample meshes
  std::vector<std::filesystem::path> merge;   // records to add up, instead of a campaign
  RecordFiles files;
};

/// Adds `keepout verify` and its options to the command line.
void add_verify(CLI::App& app, VerifyOptions& options);

/// Tries to break the guarantees of docs/certified-step.md or, if a robot or scenarios are named,
/// of docs/joint-space-step.md; or adds up earlier campaigns. Prints a table. A StopSignal ends it
/// early; then the finished part is printed and written. Returns the exit status: failure after any
/// breach. Throws Error.
int verify(const VerifyOptions& options, std::ostream& out);

}  // namespace keepout::app
