// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "compare/compare.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// keepout compare: its options, and what they lead to. Stays where it is once made.
class CompareCommand {
 public:
  explicit CompareCommand(CLI::App& app);
  CompareCommand(const CompareCommand&) = delete;
  CompareCommand& operator=(const CompareCommand&) = delete;

  /// After parsing. `arguments`: of the whole command line, to be noted. The exit status.
  int run(const std::vector<std::string>& arguments, std::ostream& out);

 private:
  CompareOptions options_;
};

}  // namespace keepout::app
