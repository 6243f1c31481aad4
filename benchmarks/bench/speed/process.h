// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sched.h>

#include <cstddef>
#include <cstdint>

namespace keepout::app {

// What the system gives to this process while it measures, and what it tells of it.

/// Keeps the calling thread, and those that it starts, on so many cores: the one that it is on, and
/// others that it was allowed when the process began. Then as before. Where the system refuses,
/// nothing happens, and holds() says so.
class OnCores {
 public:
  explicit OnCores(unsigned count) noexcept;
  ~OnCores();
  OnCores(const OnCores&) = delete;
  OnCores& operator=(const OnCores&) = delete;

  bool holds() const noexcept { return holds_; }

 private:
  cpu_set_t before_;
  bool holds_ = false;
};

/// Begins anew what peak_memory() tells. Where the system refuses, the peak is that since the
/// process began.
void reset_peak_memory();

/// Of this thread since it began.
std::uint64_t page_faults();

/// What this thread has asked of the heap and of locks since it began. malloc and its kin, and
/// pthread's mutexes and locks, are counted as they are called, by standing in for them.
struct CallCounts {
  std::size_t allocations = 0;
  std::size_t locks = 0;
};

/// Whether this build counts: one with a sanitizer does not, for that stands in for them too.
bool counts_calls() noexcept;

CallCounts calls_of_this_thread() noexcept;

}  // namespace keepout::app
