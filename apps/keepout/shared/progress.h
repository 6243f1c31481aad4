// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace keepout::app {

/// A line for people on stderr, "keepout: TEXT", for which a line that shows progress makes room.
/// The same text is said once only. For one thread.
void warn_on_stderr(const std::string& text);

/// Tells on stderr how far a long piece of work has come: on a terminal a line that is rewritten,
/// elsewhere only the line at the end, of work that took half a second or more.
///
/// Who prints something else meanwhile calls interrupt() first.
class Progress {
 public:
  Progress(std::string what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::size_t by = 1);

  /// Says at once what is being done.
  void show(const std::string& detail);

  /// Takes the line off the terminal, until the next change.
  void interrupt();

 private:
  using Clock = std::chrono::steady_clock;
  void show();

  std::string what_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::string detail_ = {};
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_ = start_;
  bool terminal_;
};

}  // namespace keepout::app
