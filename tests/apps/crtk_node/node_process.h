// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

namespace keepout::test {

/// A node as a process, which writes into a file.
class NodeProcess {
 public:
  NodeProcess(std::vector<std::string> arguments, std::filesystem::path output)
      : output_(std::move(output)), child_(::fork()) {
    if (child_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that crashes leaves no node behind
    const int file = ::open(output_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
  }
  ~NodeProcess() { stop(); }
  NodeProcess(const NodeProcess&) = delete;
  NodeProcess& operator=(const NodeProcess&) = delete;

  /// Interrupts it, waits for its end, and returns its exit status.
  int stop() {
    if (child_ > 0) ::kill(child_, SIGTERM);
    return wait();
  }

  /// Waits for its end, and returns its exit status; -1 after a signal.
  int wait() {
    if (child_ > 0) {
      int status = 0;
      ::waitpid(child_, &status, 0);
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      child_ = -1;
    }
    return status_;
  }

 private:
  std::filesystem::path output_;
  pid_t child_;
  int status_ = -1;
};

}  // namespace keepout::test
