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
  std::optional<std::filesystem::path> page;  // to be written; none: beside the record
};

/// Adds `keepout report` and its options to the command line.
void add_report(CLI::App& app, ReportOptions& options);

/// Makes the report of a record that was kept, and says on `out` where it is. Throws Error when the
/// file is no record of a format that is known, or the front end of pages is missing.
void report(const ReportOptions& options, std::ostream& out);

}  // namespace keepout::app
