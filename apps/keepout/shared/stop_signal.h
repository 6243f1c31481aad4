// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

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

  /// True after keep_from_now_on().
  bool has_something_to_keep() const noexcept;

  /// Readable from the first such signal on.
  int file() const noexcept;

  /// Whether there was such a signal.
  bool has_come() const noexcept;
};

/// True if unless_stopped() has left work behind: the process must then end without destructors of
/// static objects.
inline std::atomic<bool> has_left_work_behind{false};

/// Does work that asks for no signal, such as loading a mesh. Once there is something to keep, it
/// runs on a thread of its own, which is left behind if a signal comes first: then returns nothing.
/// `work` must own what it uses, but for what lives as long as the process.
template <class Work>
auto unless_stopped(const StopSignal& stop, Work work) -> std::optional<decltype(work())> {
  if (!stop.has_something_to_keep()) return work();
  if (stop.has_come()) return std::nullopt;
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  constexpr std::chrono::milliseconds between_looks{20};
  while (result.wait_for(between_looks) != std::future_status::ready) {
    if (!stop.has_come()) continue;
    has_left_work_behind = true;
    return std::nullopt;
  }
  return result.get();
}

}  // namespace keepout::app
