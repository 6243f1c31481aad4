// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "keepout/mesh/mesh.h"
#include "record/record.h"

namespace CLI {
class App;
}

namespace keepout::app {

struct CompareOptions {
  std::string mesh = "skull";  // a real fixture or a file
  CompareExtent extent;
  RecordFiles files;
  std::string command;  // that does it again
};

/// Everything that can take another's place, on the same input; as much as is finished when it is
/// stopped.
Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent, const Stopped& stopped);

/// Adds `keepout compare` and its options to the command line.
void add_compare(CLI::App& app, CompareOptions& options);

/// Compares, and prints tables and a headline. Throws Error. For the exit status: nonzero when
/// parts disagree by more than they may, and exit_interrupted when a signal came first.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace keepout::app
