// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>

namespace CLI {
class App;
}

namespace keepout::app {

struct ReportOptions {
  std::filesystem::path record;               // JSON that another command has written
  std::optional<std::filesystem::path> page;  // the file to write; empty: beside the record
};

/// Adds `keepout report` and its options to the command line.
void add_report(CLI::App& app, ReportOptions& options);

/// Makes the report of a record, and prints its path to `out`. Throws Error if the file is not a
/// record of the known format, or if the page template is missing.
void report(const ReportOptions& options, std::ostream& out);

}  // namespace keepout::app
