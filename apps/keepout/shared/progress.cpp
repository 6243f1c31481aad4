// SPDX-License-Identifier: BSD-3-Clause
#include "shared/progress.h"

#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

namespace keepout::app {
namespace {

constexpr const char* quiet_variable = "KEEPOUT_QUIET";
constexpr std::chrono::seconds between_plain_lines{10};

/// Blocks all signals of the calling thread, and of those that it starts meanwhile: handlers must
/// run on the thread that waits for them.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

void be_quiet() { ::setenv(quiet_variable, "1", 1); }

bool is_quiet() {
  const char* const value = std::getenv(quiet_variable);
  return value != nullptr && *value != '\0';
}

std::ostream& notices() {
  static std::ostream nowhere(nullptr);
  return is_quiet() ? nowhere : std::cerr;
}

void warn_on_stderr(const std::string& text) {
  static std::set<std::string> said;
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (!said.insert(text).second) return;
  const char* const clear = ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  std::fprintf(stderr, "%skeepout: %s\n", clear, text.c_str());
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      form_(is_quiet()                     ? Form::none
            : ::isatty(STDERR_FILENO) == 1 ? Form::rewritten_line
                                           : Form::plain_lines) {
  rewrite();
  if (form_ != Form::plain_lines) return;
  const BlockedSignals blocked;
  reporter_ = std::jthread([this](const std::stop_token& stop) { report_until(stop); });
}

Progress::~Progress() {
  if (reporter_.joinable()) {
    reporter_.request_stop();
    reporter_.join();
  }
  interrupt();
  if (form_ != Form::none && seconds() >= 0.5) {
    std::fprintf(stderr, "%s: %.1f s\n", what_.c_str(), seconds());
  }
}

void Progress::advance(std::size_t by) {
  done_.fetch_add(by, std::memory_order_relaxed);
  if (form_ != Form::rewritten_line) return;
  const Clock::time_point now = Clock::now();
  if (now - shown_ <= std::chrono::milliseconds(100)) return;
  shown_ = now;
  rewrite();
}

void Progress::show(const std::string& detail) {
  {
    const std::scoped_lock lock(mutex_);
    detail_ = detail;
  }
  rewrite();
}

void Progress::interrupt() {
  if (form_ != Form::rewritten_line) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

double Progress::percent() const {
  return total_ == 0 ? 0.0 : 100.0 * static_cast<double>(done_) / static_cast<double>(total_);
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::rewrite() {
  if (form_ != Form::rewritten_line) return;
  std::fprintf(stderr, "\r\033[K%s: %3.0f %% %s", what_.c_str(), percent(), detail_.c_str());
  std::fflush(stderr);
}

void Progress::report_until(const std::stop_token& stop) {
  const sched_param any{};
  ::sched_setscheduler(0, SCHED_BATCH, &any);  // of this thread; if it is refused, no harm is done
  std::unique_lock lock(mutex_);
  while (
      !stopped_.wait_for(lock, stop, between_plain_lines, [&] { return stop.stop_requested(); })) {
    std::fprintf(stderr, "%s: %.0f %% after %.0f s%s%s\n", what_.c_str(), percent(), seconds(),
                 detail_.empty() ? "" : ": ", detail_.c_str());
  }
}

}  // namespace keepout::app
