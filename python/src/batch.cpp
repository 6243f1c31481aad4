// SPDX-License-Identifier: BSD-3-Clause
#include "batch.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "arrays.h"

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

/// Throws if the user has interrupted. Only Python's main thread receives signals.
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
  std::stop_source stop;
  std::atomic<std::size_t> next = 0;
  const auto labour = [&](unsigned worker) {
    try {
      while (!stop.stop_requested()) {
        const std::size_t begin = next.fetch_add(chunk, std::memory_order_relaxed);
        if (begin >= items) break;
        work(worker, begin, std::min(begin + chunk, items), stop.get_token());
      }
    } catch (...) {
      stop.request_stop();
      throw;
    }
  };
  std::vector<std::future<void>> crew;  // each waits for its thread when it is destroyed
  try {
    while (crew.size() < threads) {
      crew.push_back(std::async(std::launch::async, labour, static_cast<unsigned>(crew.size())));
    }
  } catch (const std::system_error&) {
    if (crew.empty()) throw;  // the threads that exist do all the work
  }
  try {
    for (std::future<void>& worker : crew) {
      while (worker.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
        require_no_signal();
      }
    }
  } catch (...) {
    stop.request_stop();
    throw;
  }
  for (std::future<void>& worker : crew) worker.get();
}

}  // namespace keepout::python
