// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

#include "compare/compare.h"

namespace keepout::app {

/// keepout compare: its options, and what they lead to. Stays where it is once made.
class CompareCommand {
 public:
  explicit CompareCommand(CLI::App& app);
  CompareCommand(const CompareCommand&) = delete;
  CompareCommand& operator=(const CompareCommand&) = delete;

  /// After parsing. The exit status.
  int run(std::ostream& out) const { return compare(options_, out); }

 private:
  CompareOptions options_;
};

}  // namespace keepout::app
