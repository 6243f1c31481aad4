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

/// As many threads as there are processors to run on.
inline unsigned processors() noexcept { return std::max(1u, std::thread::hardware_concurrency()); }

/// The number of threads to use where the caller asks for `wanted`, 0 being all there are.
inline unsigned thread_count(unsigned wanted) noexcept {
  return wanted != 0 ? wanted : processors();
}

/// What goes wrong in the blocks of a shared work. Of several failures the one of the lowest block
/// counts, which is the one that a single thread would have met.
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

  /// Lets the blocks pass one after the other: true when it is this one's turn; false if an earlier
  /// one failed.
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

/// Runs work() on up to `threads` threads at once, this one among them. It must not throw.
template <class Work>
void on_threads(unsigned threads, const Work& work) {
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < threads) others.emplace_back(work);
  } catch (const std::system_error&) {
    // No more threads are to be had: those there are do it all.
  }
  work();
}

/// Works through blocks 0 to `blocks` - 1, handed out in this order. Each thread has a worker of
/// its own, made by make_worker(), and calls work_on(worker, block, failures) as long as that is
/// true. Throws what the lowest block threw that failed; later blocks may then have been left out.
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

/// The same for a worker that is called: worker(block).
template <class MakeWorker>
void share_blocks(std::size_t blocks, unsigned threads, const MakeWorker& make_worker) {
  share_blocks(blocks, threads, make_worker, [](auto& worker, std::size_t block, BlockFailures&) {
    worker(block);
    return true;
  });
}

/// Calls work(begin, end) for ranges that make up 0 to `size`, each of `share` items but for the
/// last one. Throws what the lowest range threw that failed.
template <class Work>
void share_ranges(std::size_t size, unsigned threads, std::size_t share, const Work& work) {
  share_blocks((size + share - 1) / share, threads, [&] {
    return [&](std::size_t block) { work(block * share, std::min((block + 1) * share, size)); };
  });
}

/// How many of a mesh's vertices or triangles are worked on at a time.
constexpr std::size_t share_size = std::size_t{1} << 13;

template <class Work>
void share_ranges(std::size_t size, unsigned threads, const Work& work) {
  share_ranges(size, threads, share_size, work);
}

/// Runs both, at the same time if `threads` > 1 and the system has a thread to give. Throws what
/// the first threw, or else the other.
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

/// The same as share_blocks for a worker of three parts: prepare(block) and finish(block) run side
/// by side with those of other blocks, commit(block) between them alone, and in the order of the
/// blocks.
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
