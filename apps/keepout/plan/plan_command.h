// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

#include "plan/plan.h"

namespace keepout::app {

/// keepout plan: its options, and what they lead to. Stays where it is once made.
class PlanCommand {
 public:
  explicit PlanCommand(CLI::App& app);
  PlanCommand(const PlanCommand&) = delete;
  PlanCommand& operator=(const PlanCommand&) = delete;

  /// After parsing. The exit status.
  int run(std::ostream& out) const { return plan(options_, out); }

 private:
  PlanOptions options_;
};

}  // namespace keepout::app
