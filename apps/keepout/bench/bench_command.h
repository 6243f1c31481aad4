// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/speed/speed.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// keepout bench: its options, and what they lead to. Stays where it is once made.
class BenchCommand {
 public:
  explicit BenchCommand(CLI::App& app);
  BenchCommand(const BenchCommand&) = delete;
  BenchCommand& operator=(const BenchCommand&) = delete;

  /// After parsing; gives the exit status. `arguments`: of the command line, for the record.
  int run(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& notes);

 private:
  /// To be called last: it has no use for most of the others.
  void add_speed_options(CLI::App& command);
  int run_speed(std::ostream& out);

  BenchOptions options_;
  SpeedOptions speed_;
  bool is_speed_ = false;
  bool list_ = false;
};

}  // namespace keepout::app
