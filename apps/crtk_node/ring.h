// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace keepout::crtk {

/// A queue of `n` items between a thread that writes and a thread that reads. Neither ever waits.
/// The items stay where they are, so that their strings keep their memory.
template <class Item, std::size_t n>
class Ring {
 public:
  /// Lets fill(item) write the next item. Returns false, and does nothing, if the ring is full.
  template <class Fill>
  bool write(const Fill& fill) {
    const std::size_t at = written_.load(std::memory_order_relaxed);
    if (at - read_.load(std::memory_order_acquire) == n) return false;
    fill(items_[at % n]);
    written_.store(at + 1, std::memory_order_release);
    return true;
  }

  /// Lets use(item) read the oldest item, and removes it. Returns false if the ring is empty.
  template <class Use>
  bool read(const Use& use) {
    const std::size_t at = read_.load(std::memory_order_relaxed);
    if (at == written_.load(std::memory_order_acquire)) return false;
    use(items_[at % n]);
    read_.store(at + 1, std::memory_order_release);
    return true;
  }

  /// Returns a number of items that fit: the reader may have made room for more since.
  std::size_t room() const { return n - (written_.load() - read_.load()); }

 private:
  std::array<Item, n> items_ = {};
  std::atomic<std::size_t> written_ = 0, read_ = 0;  // since the beginning
};

}  // namespace keepout::crtk
