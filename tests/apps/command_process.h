// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <source_location>
#include <vector>

#include "temporary_folder.h"

namespace keepout::test {

/// The outcome of a run of the command.
struct ProcessOutcome {
  int status;          // -1: killed by a signal
  std::string output;  // stdout and stderr
};

/// Returns the outcome of a run; fails the test unless the command succeeded.
inline ProcessOutcome succeeded(ProcessOutcome outcome,
                                std::source_location caller = std::source_location::current()) {
  const testing::ScopedTrace trace(caller.file_name(), static_cast<int>(caller.line()), "");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return outcome;
}

/// Runs the keepout command as a process, as a user does, in a folder of its own.
class CommandFolder : public TemporaryFolder {
 public:
  std::filesystem::path file(const std::string& name) const { return path() / name; }

  /// Runs the command. `environment`: assignments that precede it. Pages are plain unless
  /// KEEPOUT_WEB is one of them.
  ProcessOutcome run(const std::string& arguments, const std::string& environment = {}) const {
    const std::string line = "cd '" + path().string() + "' && LC_ALL=C.UTF-8 KEEPOUT_WEB=nowhere " +
                             environment + " '" KEEPOUT_COMMAND "' " + arguments + " 2>&1";
    FILE* pipe = ::popen(line.c_str(), "r");
    ProcessOutcome outcome{-1, {}};
    std::array<char, 4096> part;
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) outcome.output += part.data();
    const int status = ::pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
  }

  /// Fails unless the command rejects the arguments with these words.
  void expect_refused(const std::string& arguments, const std::string& words) const {
    const ProcessOutcome outcome = run(arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    EXPECT_CONTAINS(outcome.output, words) << arguments;
  }

  /// Runs a program until its output contains the words, and then interrupts it as Ctrl-C does.
  /// Returns its outcome.
  ProcessOutcome interrupted(std::vector<std::string> arguments, const std::string& words) const {
    std::array<int, 2> ends;
    if (::pipe(ends.data()) != 0) return {-1, "no pipe"};
    const pid_t child = ::fork();
    if (child == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::dup2(ends[1], STDERR_FILENO);
      if (::chdir(path().c_str()) != 0) ::_exit(127);
      std::vector<char*> pointers;
      for (std::string& argument : arguments) pointers.push_back(argument.data());
      pointers.push_back(nullptr);
      ::setenv("KEEPOUT_WEB", "nowhere", 1);
      ::execvp(pointers[0], pointers.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    ProcessOutcome outcome{-1, {}};
    std::array<char, 4096> part;
    bool told = false;
    for (ssize_t count; (count = ::read(ends[0], part.data(), part.size())) > 0;) {
      outcome.output.append(part.data(), static_cast<std::size_t>(count));
      if (told || outcome.output.find(words) == std::string::npos) continue;
      told = true;
      ::kill(child, SIGINT);
    }
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
  }
};

}  // namespace keepout::test
