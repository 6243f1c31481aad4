// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "temporary_folder.h"

namespace keepout::test {

/// How a run of the command ended.
struct ProcessOutcome {
  int status;          // -1: killed by a signal
  std::string output;  // stdout and stderr
};

/// The keepout command as a user meets it: run as a process, in a folder of its own.
class CommandFolder : public TemporaryFolder {
 public:
  std::filesystem::path file(const std::string& name) const { return path() / name; }

  /// `environment`: assignments that precede the command.
  ProcessOutcome run(const std::string& arguments, const std::string& environment = {}) const {
    const std::string line = "cd '" + path().string() + "' && " + environment +
                             " '" KEEPOUT_COMMAND "' " + arguments + " 2>&1";
    FILE* pipe = ::popen(line.c_str(), "r");
    ProcessOutcome outcome{-1, {}};
    std::array<char, 4096> part;
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) outcome.output += part.data();
    const int status = ::pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
  }
};

}  // namespace keepout::test
