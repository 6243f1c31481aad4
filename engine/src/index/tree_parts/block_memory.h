// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace keepout {

/// Returns memory of at least `bytes`, aligned to a cache line. Large memory is in pages of 2 MiB
/// if the system has them, because a traversal jumps from page to page. Throws std::bad_alloc.
void* allocate_blocks(std::size_t bytes);
/// Frees memory of allocate_blocks(); null is allowed.
void free_blocks(void* memory) noexcept;

/// An allocator for std::vector that leaves new elements uninitialized, so that the threads that
/// fill them touch them first.
template <class T>
struct BlockAllocator {
  using value_type = T;  // required by std::allocator_traits

  BlockAllocator() = default;
  /// Converts from an allocator of any type, as there is no state.
  template <class U>
  BlockAllocator(const BlockAllocator<U>&) noexcept {}

  /// Returns memory for `count` items, aligned to a cache line. Throws std::bad_alloc.
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_blocks(count * sizeof(T))); }
  /// Frees the memory.
  void deallocate(T* memory, std::size_t) noexcept { free_blocks(memory); }

  /// Makes an item without a value, and does not touch its memory.
  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  /// Makes an item from arguments.
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  /// Returns true, because every allocator can free the memory of another.
  friend bool operator==(const BlockAllocator&, const BlockAllocator&) noexcept { return true; }
};

/// A vector in such memory, whose new elements have no value yet.
template <class T>
using BlockVector = std::vector<T, BlockAllocator<T>>;

}  // namespace keepout
