// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace keepout {

/// Returns the number of processors, at least 1.
inline unsigned processors() noexcept { return std::max(1u, std::thread::hardware_concurrency()); }

/// Returns the number of threads for a caller's option `wanted`, where 0 means one for each
/// processor.
inline unsigned thread_count(unsigned wanted) noexcept {
  return wanted != 0 ? wanted : processors();
}

/// The failures in the blocks of a shared task. The failure of the lowest block counts, because a
/// single thread would have met that one.
class BlockFailures {
 public:
  void add(std::size_t block) noexcept {
    const std::lock_guard lock(mutex_);
    if (block < first_) {
      first_ = block;
      exception_ = std::current_exception();
    }
    changed_.notify_all();
  }

  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

  /// Waits for the turn of a block, as blocks pass in order. Returns true at its turn, and false if
  /// an earlier block failed.
  bool await_turn(std::size_t block) noexcept {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return turn_ == block || first_ < block; });
    return first_ > block;
  }

  void end_turn() noexcept {
    const std::lock_guard lock(mutex_);
    ++turn_;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t turn_ = 0;
  std::size_t first_ = std::numeric_limits<std::size_t>::max();
  std::exception_ptr exception_;
};

/// Runs work() on up to `threads` threads at once, including this one. work() must not throw.
template <class Work>
void on_threads(unsigned threads, const Work& work) {
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < threads) others.emplace_back(work);
  } catch (const std::system_error&) {
    // The system has no more threads, so the present ones do all the work.
  }
  work();
}

/// Processes blocks 0 to `blocks` - 1, handed out in this order. Each thread makes a worker with
/// make_worker(), and calls work_on(worker, block, failures) until it returns false. Rethrows the
/// exception of the lowest block that failed; later blocks may then be missing.
template <class MakeWorker, class WorkOn>
void share_blocks(std::size_t blocks, unsigned threads, const MakeWorker& make_worker,
                  const WorkOn& work_on) {
  std::atomic<std::size_t> next = 0;
  BlockFailures failures;
  const auto work = [&]() noexcept {
    std::size_t block = blocks;
    try {
      auto worker = make_worker();
      while ((block = next++) < blocks && work_on(worker, block, failures)) continue;
    } catch (...) {
      failures.add(block);
      next = blocks;
    }
  };
  on_threads(static_cast<unsigned>(std::min<std::size_t>(threads, blocks)), work);
  failures.rethrow();
}

/// Like share_blocks(), for workers that are called as worker(block).
template <class MakeWorker>
void share_blocks(std::size_t blocks, unsigned threads, const MakeWorker& make_worker) {
  share_blocks(blocks, threads, make_worker, [](auto& worker, std::size_t block, BlockFailures&) {
    worker(block);
    return true;
  });
}

/// Calls work(begin, end) for ranges that together are 0 to `size`. Each has `share` items, except
/// the last. Rethrows the exception of the lowest range that failed.
template <class Work>
void share_ranges(std::size_t size, unsigned threads, std::size_t share, const Work& work) {
  share_blocks((size + share - 1) / share, threads, [&] {
    return [&](std::size_t block) { work(block * share, std::min((block + 1) * share, size)); };
  });
}

/// The number of a mesh's vertices or triangles in a block.
constexpr std::size_t share_size = std::size_t{1} << 13;

template <class Work>
void share_ranges(std::size_t size, unsigned threads, const Work& work) {
  share_ranges(size, threads, share_size, work);
}

/// Runs both functions, at the same time if `threads` > 1 and the system has a thread. Rethrows the
/// exception of the first function, or else that of the second.
template <class One, class Other>
void run_both(unsigned threads, const One& one, const Other& other) {
  if (threads <= 1) {
    one();
    other();
    return;
  }
  share_blocks(2, threads,
               [&] { return [&](std::size_t block) { block == 0 ? one() : other(); }; });
}

/// Like share_blocks(), for workers of three parts. prepare(block) and finish(block) run in
/// parallel with those of other blocks. commit(block) runs between them, one block at a time and in
/// order.
template <class MakeWorker>
void share_blocks_in_order(std::size_t blocks, unsigned threads, const MakeWorker& make_worker) {
  share_blocks(blocks, threads, make_worker,
               [](auto& worker, std::size_t block, BlockFailures& failures) {
                 worker.prepare(block);
                 if (!failures.await_turn(block)) return false;
                 worker.commit(block);
                 failures.end_turn();
                 worker.finish(block);
                 return true;
               });
}

}  // namespace keepout
