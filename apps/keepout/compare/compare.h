// SPDX-FileCopyrightText: 2026 the keepout authors
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
#include "stop_signal.h"

namespace CLI {
class App;
}

namespace keepout::app {

struct CompareOptions {
  std::string mesh = "skull";  // a real fixture or a file
  CompareExtent extent;
  std::optional<std::filesystem::path> json;  // to be written
};

/// Everything that can take another's place, on the same input; as much as is finished when `stop`,
/// which may be null, has come.
Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent, const StopSignal* stop = nullptr);

/// keepout compare: its options, and what they lead to. Stays where it is once made.
class CompareCommand {
 public:
  explicit CompareCommand(CLI::App& app);
  CompareCommand(const CompareCommand&) = delete;
  CompareCommand& operator=(const CompareCommand&) = delete;

  /// After parsing: compares, and prints tables and a verdict. `arguments`: of the whole command
  /// line, to be noted. Throws Error. For the exit status: nonzero when parts disagree by more than
  /// they may, and exit_interrupted when a signal came first.
  int run(const std::vector<std::string>& arguments, std::ostream& out) const;

 private:
  CompareOptions options_;
};

}  // namespace keepout::app
