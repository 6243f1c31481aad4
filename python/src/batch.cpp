// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "batch.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "arguments.h"

namespace keepout::python {
namespace {

constexpr py::ssize_t most_threads = 1024;

unsigned usable_processors() noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) {
    return static_cast<unsigned>(CPU_COUNT(&set));
  }
  return std::max(1U, std::thread::hardware_concurrency());
}

/// Threads that share a list of chunks, and what became of them.
class Crew {
 public:
  Crew(std::size_t items, std::size_t chunk, const Work& work)
      : items_(items), chunk_(chunk), work_(work) {}

  /// If the system has no more threads, those that there are do it all.
  void start(unsigned threads) {
    running_ = threads;
    for (unsigned worker = 0; worker < threads; ++worker) {
      try {
        threads_.emplace_back([this, worker] { labour(worker); });
      } catch (const std::system_error&) {
        const std::lock_guard lock(mutex_);
        running_ -= threads - worker;
        if (worker == 0) throw;
        break;
      }
    }
  }

  /// Whether all have ended within a while.
  bool has_ended_within(std::chrono::milliseconds while_waiting) {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, while_waiting, [&] { return running_ == 0; });
  }

  void stop() noexcept { stop_.ask(); }

  void join() noexcept {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void labour(unsigned worker) noexcept {
    try {
      while (!stop_.asked()) {
        const std::size_t begin = next_.fetch_add(chunk_, std::memory_order_relaxed);
        if (begin >= items_) break;
        work_(worker, begin, std::min(begin + chunk_, items_), stop_);
      }
    } catch (...) {
      stop_.ask();
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    if (--running_ == 0) ended_.notify_one();
  }

  std::size_t items_;
  std::size_t chunk_;
  const Work& work_;
  std::atomic<std::size_t> next_ = 0;
  Stop stop_;
  std::mutex mutex_;
  std::condition_variable ended_;
  unsigned running_ = 0;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

/// Only Python's main thread hears of signals; elsewhere nothing is ever pending.
void require_no_signal() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

unsigned threads_for(std::size_t items, std::optional<py::ssize_t> wanted) {
  if (wanted && (*wanted < 1 || *wanted > most_threads)) {
    refuse("threads", "1 to " + std::to_string(most_threads) + ", or None for every processor",
           std::to_string(*wanted));
  }
  const std::size_t threads = wanted ? static_cast<std::size_t>(*wanted) : usable_processors();
  return static_cast<unsigned>(
      std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(items, 1)));
}

void run_batch(std::size_t items, std::size_t chunk, unsigned threads, const Work& work) {
  if (items == 0) return;
  Crew crew(items, chunk, work);
  try {
    crew.start(threads);
    while (!crew.has_ended_within(std::chrono::milliseconds(50))) require_no_signal();
  } catch (...) {
    crew.stop();
    crew.join();
    throw;
  }
  crew.join();
  crew.rethrow();
}

}  // namespace keepout::python
