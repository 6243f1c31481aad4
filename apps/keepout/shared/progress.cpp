// SPDX-License-Identifier: BSD-3-Clause
#include "shared/progress.h"

#include <unistd.h>

#include <cstdio>
#include <set>
#include <utility>

namespace keepout::app {

void warn_on_stderr(const std::string& text) {
  static std::set<std::string> said;
  if (!said.insert(text).second) return;
  const char* const clear = ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  std::fprintf(stderr, "%skeepout: %s\n", clear, text.c_str());
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)), total_(total), terminal_(::isatty(STDERR_FILENO) == 1) {
  if (terminal_) show();
}

Progress::~Progress() {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  interrupt();
  if (seconds >= 0.5) std::fprintf(stderr, "%s: %.1f s\n", what_.c_str(), seconds);
}

void Progress::advance(std::size_t by) {
  done_ += by;
  const Clock::time_point now = Clock::now();
  if (terminal_ && now - shown_ > std::chrono::milliseconds(100)) {
    shown_ = now;
    show();
  }
}

void Progress::show(const std::string& detail) {
  detail_ = detail;
  if (terminal_) show();
}

void Progress::interrupt() {
  if (!terminal_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

void Progress::show() {
  const double percent =
      total_ == 0 ? 0.0 : 100.0 * static_cast<double>(done_) / static_cast<double>(total_);
  std::fprintf(stderr, "\r\033[K%s: %3.0f %% %s", what_.c_str(), percent, detail_.c_str());
  std::fflush(stderr);
}

}  // namespace keepout::app
