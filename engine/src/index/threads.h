// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace keepout {

/// The number of threads to use where the caller asks for `wanted`, 0 being all there are.
inline unsigned thread_count(unsigned wanted) noexcept {
  return wanted != 0 ? wanted : std::max(1u, std::thread::hardware_concurrency());
}

/// Runs both, at the same time if `threads` > 1 and the system has a thread to give. Neither may
/// throw.
template <class One, class Other>
void run_both(unsigned threads, const One& one, const Other& other) {
  std::thread helper;
  if (threads > 1) {
    try {
      helper = std::thread(one);
    } catch (const std::system_error&) {
      // No thread to be had: one after the other, then.
    }
  }
  if (!helper.joinable()) one();
  other();
  if (helper.joinable()) helper.join();
}

/// Calls work(begin, end) on ranges that together are 0 .. count. It may not throw.
template <class Work>
void for_ranges(unsigned threads, std::size_t begin, std::size_t end, const Work& work) {
  if (threads <= 1 || end - begin < 2) {
    if (begin < end) work(begin, end);
    return;
  }
  const std::size_t middle = begin + (end - begin) * (threads / 2) / threads;
  run_both(
      threads, [&] { for_ranges(threads / 2, begin, middle, work); },
      [&] { for_ranges(threads - threads / 2, middle, end, work); });
}

}  // namespace keepout
