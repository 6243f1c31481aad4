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

// The system delivers a signal to any thread of the process, also to one of an index's library.
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
  // Restores the earlier action: the second signal acts as if this handler did not exist.
  for (std::size_t i = 0; i < stopping.size(); ++i) {
    if (stopping[i] == signal) ::sigaction(signal, &earlier_actions[i], nullptr);
  }
  const std::uint64_t one = 1;
  // This fails only if the signal is already noted.
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
    // A signal that was ignored from the start, as under nohup, stays ignored.
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
