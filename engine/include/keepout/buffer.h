// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace keepout {

/// A list with a fixed capacity: it never allocates after construction, and never drops an element
/// silently. If an element does not fit, the buffer records an overflow, which a step reports as a
/// status.
template <class T>
class Buffer {
 public:
  /// Allocates memory for `capacity` items. No other function allocates.
  explicit Buffer(std::size_t capacity) : items_(capacity) {}

  /// Appends an item, or records an overflow if the buffer is full.
  void push(const T& item) noexcept {
    if (size_ < items_.size()) {
      items_[size_++] = item;
    } else {
      overflowed_ = true;
    }
  }

  /// Records an overflow: there are more items than the buffer holds.
  void give_up() noexcept { overflowed_ = true; }

  /// Appends the first `count` items that the caller has written at end(). Precondition: size() +
  /// count <= capacity().
  void grow(std::size_t count) noexcept { size_ += count; }

  /// Removes all items except the first `count`, and clears an overflow. Precondition: count <=
  /// size().
  void shrink(std::size_t count) noexcept {
    size_ = count;
    overflowed_ = false;
  }

  /// Replaces the contents. Precondition: `items` is not a view of this buffer.
  void assign(std::span<const T> items) noexcept {
    clear();
    for (const T& item : items) push(item);
  }

  /// Removes all items, and clears an overflow.
  void clear() noexcept {
    size_ = 0;
    overflowed_ = false;
  }

  /// Returns true if an overflow was recorded since the last shrink() or clear().
  bool overflowed() const noexcept { return overflowed_; }
  /// Returns true if the buffer has no items.
  bool empty() const noexcept { return size_ == 0; }
  /// Returns the number of items.
  std::size_t size() const noexcept { return size_; }
  /// Returns the largest number of items.
  std::size_t capacity() const noexcept { return items_.size(); }

  /// Returns item i. Precondition: i < size().
  T& operator[](std::size_t i) noexcept { return items_[i]; }
  /// Returns item i. Precondition: i < size().
  const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  /// Returns the first item. The pointer is valid as long as the buffer lives.
  T* begin() noexcept { return items_.data(); }
  /// Returns the end of the items; the memory up to capacity() may be written.
  T* end() noexcept { return items_.data() + size_; }
  /// Returns the first item.
  const T* begin() const noexcept { return items_.data(); }
  /// Returns the end of the items.
  const T* end() const noexcept { return items_.data() + size_; }
  /// Returns all items. The view is valid until the contents change.
  std::span<const T> view() const noexcept { return {items_.data(), size_}; }

 private:
  std::vector<T> items_;
  std::size_t size_ = 0;
  bool overflowed_ = false;
};

}  // namespace keepout
