// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace keepout {

/// A list with a capacity declared at construction: it never allocates afterwards, and it never
/// drops an element silently. What does not fit is remembered as an overflow, which the step turns
/// into a status.
template <class T>
class Buffer {
 public:
  /// Makes room for `capacity` items. Allocates; nothing after it does.
  explicit Buffer(std::size_t capacity) : items_(capacity) {}

  /// Appends, or marks the overflow when full.
  void push(const T& item) noexcept {
    if (size_ < items_.size()) {
      items_[size_++] = item;
    } else {
      overflowed_ = true;
    }
  }

  /// Marks the overflow: there is more than is written here.
  void give_up() noexcept { overflowed_ = true; }

  /// Takes in the first `count` items of those that the caller wrote at end(): a way to append many
  /// at once. Precondition: there is room, size() + count <= capacity().
  void grow(std::size_t count) noexcept { size_ += count; }

  /// Keeps the first `count` items. Precondition: count <= size().
  void shrink(std::size_t count) noexcept { size_ = count; }

  /// Replaces the contents. The items must not be in this buffer.
  void assign(std::span<const T> items) noexcept {
    clear();
    for (const T& item : items) push(item);
  }

  /// Lets go of all items, and forgets an overflow.
  void clear() noexcept {
    size_ = 0;
    overflowed_ = false;
  }

  /// True if anything was pushed beyond the capacity since the last clear().
  bool overflowed() const noexcept { return overflowed_; }
  /// Whether nothing is in it.
  bool empty() const noexcept { return size_ == 0; }
  /// How many items are in it.
  std::size_t size() const noexcept { return size_; }
  /// How many there is room for.
  std::size_t capacity() const noexcept { return items_.size(); }

  /// Item i. Precondition: i < size().
  T& operator[](std::size_t i) noexcept { return items_[i]; }
  /// Item i. Precondition: i < size().
  const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  /// The first item, and where the next one would go: valid as long as the buffer lives.
  T* begin() noexcept { return items_.data(); }
  /// Behind the last item; room up to capacity() follows.
  T* end() noexcept { return items_.data() + size_; }
  /// The first item.
  const T* begin() const noexcept { return items_.data(); }
  /// Behind the last item.
  const T* end() const noexcept { return items_.data() + size_; }
  /// All items. Valid until the contents change.
  std::span<const T> view() const noexcept { return {items_.data(), size_}; }

 private:
  std::vector<T> items_;
  std::size_t size_ = 0;
  bool overflowed_ = false;
};

}  // namespace keepout
