// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace keepout::app {

/// The exit status of a command that was interrupted and has kept what it had finished: that which
/// a shell gives to what Ctrl-C ended.
inline constexpr int exit_interrupted = 130;

/// The message that a command with finished results prints as soon as a signal comes.
inline constexpr std::string_view keeps_what_is_finished =
    "keepout: stopping; what is finished is kept. The same signal again ends it at once.\n";

/// The effect of a signal before the first result is finished.
enum class BeforeWork {
  is_noted,     // as later
  ends_process  // at once, without files, with exit_interrupted
};

/// Takes SIGHUP, SIGINT and SIGTERM for a wish to end, which poll() can wait for and long work can
/// ask for, so that it keeps what it has finished; the same signal once more ends the process at
/// once. One at a time.
class StopSignal {
 public:
  /// The handler writes `said`, a literal, to stderr at once, unless --quiet is given. Throws Error
  /// when the system has no more files.
  explicit StopSignal(std::string_view said = {}, BeforeWork before = BeforeWork::is_noted);
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// To be called once there is something to keep: from now on, signals are noted.
  void keep_from_now_on() const noexcept;

  /// Readable from the first such signal on.
  int file() const noexcept;

  /// Whether there was such a signal.
  bool has_come() const noexcept;
};

}  // namespace keepout::app
