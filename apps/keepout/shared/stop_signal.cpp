// SPDX-License-Identifier: BSD-3-Clause
#include "shared/stop_signal.h"

#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include "keepout/error.h"
#include "shared/output_file.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

constexpr std::array stopping{SIGHUP, SIGINT, SIGTERM};

// Signals come to the process, on whatever thread: those of an index's library among them.
std::atomic<int> event_file{-1};
std::atomic<bool> noted{false};
std::atomic<bool> ends_process{false};
std::string_view said_at_once;

/// Writes to stderr from a signal handler.
void say(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}
std::array<struct sigaction, stopping.size()> earlier_actions;

void note(int signal) {
  const int error = errno;
  if (ends_process) {
    say("keepout: stopped before anything was finished: nothing was written\n");
    remove_partial_files();
    ::_exit(exit_interrupted);
  }
  if (!noted.exchange(true)) say(said_at_once);
  // A second one is not waited for: it does what it did before.
  for (std::size_t i = 0; i < stopping.size(); ++i) {
    if (stopping[i] == signal) ::sigaction(signal, &earlier_actions[i], nullptr);
  }
  const std::uint64_t one = 1;
  // It can fail only if it is noted already.
  [[maybe_unused]] const ssize_t written = ::write(event_file.load(), &one, sizeof one);
  errno = error;
}

}  // namespace

StopSignal::StopSignal(std::string_view said, BeforeWork before) {
  noted = false;
  ends_process = before == BeforeWork::ends_process;
  said_at_once = is_quiet() ? std::string_view() : said;
  event_file = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (event_file < 0) throw Error(std::string("no event file: ") + std::strerror(errno));
  struct sigaction action = {};
  ::sigemptyset(&action.sa_mask);
  action.sa_handler = note;
  for (std::size_t i = 0; i < stopping.size(); ++i) {
    ::sigaction(stopping[i], &action, &earlier_actions[i]);
    // What was ignored from the start, as under nohup, stays ignored.
    if (earlier_actions[i].sa_handler == SIG_IGN) {
      ::sigaction(stopping[i], &earlier_actions[i], nullptr);
    }
  }
}

StopSignal::~StopSignal() {
  for (std::size_t i = 0; i < stopping.size(); ++i) {
    ::sigaction(stopping[i], &earlier_actions[i], nullptr);
  }
  ::close(event_file.exchange(-1));
}

void StopSignal::keep_from_now_on() const noexcept { ends_process = false; }

bool StopSignal::has_something_to_keep() const noexcept { return !ends_process.load(); }

int StopSignal::file() const noexcept { return event_file.load(); }

bool StopSignal::has_come() const noexcept { return noted.load(); }

}  // namespace keepout::app
