// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <iosfwd>
#include <mutex>
#include <string>
#include <thread>

namespace keepout::app {

/// Prints no progress and no notices from now on: the option --quiet. Errors and warnings stay.
/// Sets the environment variable KEEPOUT_QUIET, which programs that this one starts obey as well.
void be_quiet();

/// Returns true if KEEPOUT_QUIET is set.
bool is_quiet();

/// Returns the stream of notices: stderr, or one that discards them if is_quiet().
std::ostream& notices();

/// Prints a warning on stderr, "keepout: TEXT", after clearing a line that shows progress. Prints
/// the same text only once.
void warn_on_stderr(const std::string& text);

/// Shows on stderr how much of a long piece of work is done: on a terminal in a line that is
/// rewritten; elsewhere in a plain line every 10 seconds, and one at the end of work that took half
/// a second or more. Shows nothing if is_quiet().
///
/// The plain lines come from a thread of its own, so the work need not call advance() often. The
/// thread sleeps between lines and has the scheduling policy SCHED_BATCH: waking, it does not
/// preempt work that is being timed.
///
/// A caller that prints something else to the terminal meanwhile must call interrupt() first.
class Progress {
 public:
  Progress(std::string what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::size_t by = 1);

  /// Shows at once what is being done.
  void show(const std::string& detail);

  /// Clears the line on the terminal, until the next change.
  void interrupt();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Form { none, rewritten_line, plain_lines };

  double percent() const;
  double seconds() const;
  void rewrite();
  void report_until(const std::stop_token& stop);

  std::string what_;
  std::size_t total_;
  std::atomic<std::size_t> done_ = 0;
  std::string detail_ = {};  // the mutex guards it
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_ = start_;
  Form form_;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread reporter_;  // the last member: it uses the others until it is joined
};

}  // namespace keepout::app
