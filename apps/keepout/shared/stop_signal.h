// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace keepout::app {

/// The exit status of a command that was interrupted and has kept what it had finished: that which
/// a shell gives to what Ctrl-C ended.
inline constexpr int exit_interrupted = 130;

/// Takes SIGHUP, SIGINT and SIGTERM for a wish to end, which poll() can wait for and long work can
/// ask for, so that it keeps what it has finished; the same signal once more ends the process at
/// once. One at a time.
class StopSignal {
 public:
  /// Throws Error when the system has no more files.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Readable from the first such signal on.
  int file() const noexcept;

  /// Whether there was such a signal.
  bool has_come() const noexcept;
};

}  // namespace keepout::app
